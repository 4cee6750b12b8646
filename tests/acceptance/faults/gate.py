"""A TCP proxy between two parts of the lab: what a broken network, or a sick object store, looks like from one side."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Coroutine
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from tests.acceptance.faults.fault import Kind

PIECE_BYTES = 256 * 1024
WAIT_S = 10.0
Target = Path | tuple[str, int]

# what an S3-compatible store says when it is ill
_REFUSAL_BODY = b'<?xml version="1.0" encoding="UTF-8"?><Error><Code>InternalError</Code><Message>ill</Message></Error>'
_REFUSAL = (
    b"HTTP/1.1 500 Internal Server Error\r\nContent-Type: application/xml\r\nConnection: close\r\n"
    b"Content-Length: %d\r\n\r\n%s" % (len(_REFUSAL_BODY), _REFUSAL_BODY)
)


class Gates:
    """The thread all gates run in."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="gates", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.call(self._end_all())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def call(self, work: Coroutine[Any, Any, Any]) -> Any:
        """From any other thread."""
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(WAIT_S)

    def open(self, target: Target) -> Gate:
        """A gate before a unix socket or a TCP port."""
        gate = Gate(self, target)
        self.call(gate.listen())
        return gate

    async def _end_all(self) -> None:
        mine = asyncio.current_task()
        rest = [task for task in asyncio.all_tasks() if task is not mine]
        for task in rest:
            task.cancel()
        await asyncio.gather(*rest, return_exceptions=True)


class Gate:
    """Open at first; `shut` and `open` it."""

    def __init__(self, gates: Gates, target: Target) -> None:
        self.port = 0
        self._gates = gates
        self._target = target
        self._mode: Kind | None = None
        self._carrying = asyncio.Event()
        self._carrying.set()
        self._writers: set[asyncio.StreamWriter] = set()

    async def listen(self) -> None:
        """On a free port of loopback."""
        server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        self.port = server.sockets[0].getsockname()[1]
        self._server = server

    def shut(self, kind: Kind) -> None:
        """CUT, HANG or REFUSE from now on."""
        self._gates.call(self._change(kind))

    def open(self) -> None:
        """What hung goes on."""
        self._gates.call(self._change(None))

    async def _change(self, mode: Kind | None) -> None:
        self._mode = mode
        if mode is Kind.HANG:
            self._carrying.clear()
            return
        self._carrying.set()
        if mode is not None:
            for writer in tuple(self._writers):
                writer.transport.abort()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._writers.add(writer)
        try:
            await self._carrying.wait()
            if self._mode is Kind.REFUSE:
                await reader.readuntil(b"\r\n\r\n")
                writer.write(_REFUSAL)
                await writer.drain()
            elif self._mode is None:
                await self._carry(reader, writer)
        except (OSError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
            return
        finally:
            self._writers.discard(writer)
            writer.close()

    async def _carry(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if isinstance(self._target, Path):
            far_reader, far_writer = await asyncio.open_unix_connection(self._target)
        else:
            far_reader, far_writer = await asyncio.open_connection(*self._target)
        self._writers.add(far_writer)
        try:
            there = asyncio.create_task(self._pump(reader, far_writer))
            back = asyncio.create_task(self._pump(far_reader, writer))
            await asyncio.wait((there, back), return_when=asyncio.FIRST_COMPLETED)
            for task in (there, back):  # neither PostgreSQL nor S3 goes on with half a connection
                task.cancel()
            await asyncio.gather(there, back, return_exceptions=True)
        finally:
            self._writers.discard(far_writer)
            far_writer.close()

    async def _pump(self, source: asyncio.StreamReader, sink: asyncio.StreamWriter) -> None:
        with suppress(OSError):
            while piece := await source.read(PIECE_BYTES):
                await self._carrying.wait()
                sink.write(piece)
                await sink.drain()
