"""One connection, with what the HTTP server leaves open: how many there may be, and how slow.

Without bounds a client could send header lines without end, which all stay in memory, or one byte a minute on as many
connections as it likes, or ask for large files and never read them. Bodies are bounded where they are read
(api/body_limit.py, api/request_body.py).
"""

from __future__ import annotations

import asyncio
import json
from functools import partial
from http import HTTPStatus
from typing import Any, cast

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from api.crowd import Crowd
from api.problems import MEDIA_TYPE
from api.request_context import SECURITY_HEADERS
from api.request_id import HEADER, choose_request_id
from store.settings import Settings

HEAD_BYTES = 64 * 1024
HEAD_S = 20.0  # from the first byte, or from the connection, to the last header line
UNREAD_S = 60.0  # for 48 KiB of an answer: whoever reads slower than 0.8 kB a second holds a place for nothing
CROWDED = "connections.exceeded"


class GuardedConnection(HttpToolsProtocol):
    """Ends what sends too much or too little before its request has begun, and tells why by a problem; and what does not read."""

    def __init__(self, crowd: Crowd, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._crowd = crowd
        self._unread: asyncio.TimerHandle | None = None
        self._head_bytes = 0
        self._in_head = True
        self._patience: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._be_patient()
        if not self._crowd.enter(self._address):
            self._refuse(
                503, CROWDED, f"There are {self._crowd.most_of_one} connections of your address or {self._crowd.most} in all"
            )

    def connection_lost(self, exc: Exception | None) -> None:
        self._crowd.leave(self._address)
        self._end_patience()
        self.resume_writing()
        super().connection_lost(exc)

    def pause_writing(self) -> None:
        self._unread = self.loop.call_later(UNREAD_S, self.transport.abort)
        super().pause_writing()

    def resume_writing(self) -> None:
        if self._unread is not None:
            self._unread.cancel()
            self._unread = None
        super().resume_writing()

    def data_received(self, data: bytes) -> None:
        if self.transport.is_closing():  # refused: what still comes is nobody's
            return
        if self._patience is None and (self.cycle is None or self.cycle.response_complete):
            self._be_patient()  # also for what comes between requests and begins none
        super().data_received(data)
        if self._in_head and not self.transport.is_closing():
            self._head_bytes += len(data)
            if self._head_bytes > HEAD_BYTES:
                self._refuse(431, "request.head_too_large", f"Request line and headers may have {HEAD_BYTES} bytes together")

    def on_message_begin(self) -> None:
        self._in_head, self._head_bytes = True, 0
        if self._patience is None:
            self._be_patient()
        super().on_message_begin()

    def on_body(self, body: bytes) -> None:
        held = self.cycle.body
        if not held:  # what is added to no bytes is not copied, what is added to uvicorn's empty bytearray is
            self.cycle.body = b""  # type: ignore[assignment]
        elif isinstance(held, bytes):  # of many small chunks each would copy all before it
            self.cycle.body = bytearray(held)
        super().on_body(body)

    def on_headers_complete(self) -> None:
        self._in_head = False
        self._end_patience()
        super().on_headers_complete()

    def send_400_response(self, msg: str) -> None:
        self._refuse(400, "request.malformed", msg)

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    def _be_patient(self) -> None:
        self._patience = self.loop.call_later(HEAD_S, self._lose_patience)

    def _end_patience(self) -> None:
        if self._patience is not None:
            self._patience.cancel()
            self._patience = None

    def _lose_patience(self) -> None:
        self._patience = None
        if not self.transport.is_closing():
            self._refuse(408, "request.head_too_slow", f"No whole request came within {HEAD_S:g} s")

    def _refuse(self, status: int, code: str, detail: str) -> None:
        """An answer of our own: no request there is that the application could answer."""
        phrase, request_id = HTTPStatus(status).phrase, choose_request_id(None)
        problem = {
            "type": f"urn:integument:problem:{code}",
            "title": phrase,
            "status": status,
            "detail": detail,
            "code": code,
            "request_id": request_id,
            "retryable": status in (HTTPStatus.REQUEST_TIMEOUT, HTTPStatus.SERVICE_UNAVAILABLE),
        }
        body = json.dumps(problem).encode()
        headers = {
            "Content-Type": MEDIA_TYPE,
            "Content-Length": str(len(body)),
            "Cache-Control": "no-store",
            "Connection": "close",
            HEADER: request_id,
            **SECURITY_HEADERS,
        }
        lines = [f"HTTP/1.1 {status} {phrase}", *(f"{name}: {value}" for name, value in headers.items()), "", ""]
        self.transport.write("\r\n".join(lines).encode("ascii") + body)
        self.transport.close()


def guarded_connections(settings: Settings) -> type[asyncio.Protocol]:
    """What the HTTP server makes a connection of: all of them know how many there are."""
    make = partial(GuardedConnection, Crowd(settings.connections, settings.connections_per_address))
    return cast(type[asyncio.Protocol], make)  # it is called, and nothing else
