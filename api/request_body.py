"""A large request body, a piece at a time."""

from __future__ import annotations

import contextlib
from collections.abc import AsyncIterator

import anyio
from starlette.requests import Request

from core.errors import InputError

PIECE_BYTES = 1024 * 1024  # written at a time
PIECE_CHUNKS = 512  # however small they are; the kernel takes 1,024 in one call
SILENCE_S = 60.0  # a client that sends nothing for that long is gone
DRAIN_S = 10.0


class RequestBody:
    """The request body in pieces of about PIECE_BYTES, each the chunks as they came: putting them together would copy them."""

    def __init__(self, request: Request) -> None:
        self._receive = request.receive
        self.size = 0
        self._more = True

    async def pieces(self) -> AsyncIterator[list[bytes]]:
        """Raises InputError `upload.interrupted` if the client goes away."""
        chunks: list[bytes] = []
        yielded = 0
        while self._more:
            chunks.append(await self._next())
            if self.size - yielded >= PIECE_BYTES or len(chunks) >= PIECE_CHUNKS or not self._more:
                yielded = self.size
                yield chunks
                chunks = []

    async def drain(self) -> None:
        """Read and forget what is still coming: a client that is still sending would not see the answer."""
        with anyio.move_on_after(DRAIN_S), contextlib.suppress(InputError):
            while self._more:
                await self._next()

    async def _next(self) -> bytes:
        with anyio.move_on_after(SILENCE_S) as patience:
            message = await self._receive()
        if patience.cancelled_caught:
            self._more = False
            raise InputError("upload.interrupted", f"Nothing came for {SILENCE_S:g} s after {self.size} bytes", size=self.size)
        if message["type"] == "http.disconnect":
            self._more = False
            raise InputError("upload.interrupted", f"The upload broke off after {self.size} bytes", size=self.size)
        self._more = bool(message.get("more_body", False))
        chunk: bytes = message.get("body", b"")
        self.size += len(chunk)
        return chunk
