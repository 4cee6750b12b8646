"""One connection, with what the HTTP server leaves open: bounds for the head of a request, in bytes and in time.

Without them a client could send header lines without end, which all stay in memory, or one byte a minute on as many
connections as it likes. Bodies are bounded where they are read (api/body_limit.py, api/request_body.py).
"""

from __future__ import annotations

import asyncio
import json
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from api.problems import MEDIA_TYPE
from api.request_context import SECURITY_HEADERS
from api.request_id import HEADER, choose_request_id

HEAD_BYTES = 64 * 1024
HEAD_S = 20.0  # from the first byte, or from the connection, to the last header line


class GuardedConnection(HttpToolsProtocol):
    """Ends what sends too much or too little before its request has begun; tells why by a problem, as everywhere."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self._head_bytes = 0
        self._in_head = True
        self._patience: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._be_patient()

    def connection_lost(self, exc: Exception | None) -> None:
        self._end_patience()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
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

    def on_headers_complete(self) -> None:
        self._in_head = False
        self._end_patience()
        super().on_headers_complete()

    def send_400_response(self, msg: str) -> None:
        self._refuse(400, "request.malformed", msg)

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
            "retryable": status == HTTPStatus.REQUEST_TIMEOUT,
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
