"""No route but uploads takes a large body."""

from __future__ import annotations

from collections.abc import Callable

import anyio
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MAX_BODY_BYTES = 1024 * 1024
MAX_SEPARATORS = 50_000  # commas: a megabyte of `1,1,1` would be half a million values, each refused with reasons of its own
TOO_MANY_BYTES = f"The body may have {MAX_BODY_BYTES} bytes at this route"
TOO_MANY_VALUES = f"The body may have {MAX_SEPARATORS} commas at this route"
DRAIN_S = 5.0
BODY_S = 60.0  # for the whole of it, however it trickles


class BodyLimit:
    """ASGI middleware: reading a body beyond the limits raises HTTPException 413, one slower than BODY_S 408.

    What still comes is read and forgotten for a while: a client that is still sending would not see the answer."""

    def __init__(self, app: ASGIApp, counts_itself: Callable[[str, str], bool]) -> None:
        """counts_itself(method, path): whether the route looks after its own bytes."""
        self.app = app
        self.counts_itself = counts_itself

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or self.counts_itself(scope["method"], scope["path"]):
            await self.app(scope, receive, send)
            return
        declared = Headers(scope=scope).get("content-length", "0")
        size, separators, more, latest = 0, 0, True, anyio.current_time() + BODY_S

        async def limited() -> Message:
            nonlocal size, separators, more
            if not more:  # all that can still come is the end of the connection
                return await receive()
            if not declared.isdecimal() or int(declared[:18]) > MAX_BODY_BYTES:
                await drain(receive)
                raise HTTPException(413, TOO_MANY_BYTES)
            with anyio.move_on_after(latest - anyio.current_time()) as patience:
                message = await receive()
            if patience.cancelled_caught:
                raise HTTPException(408)
            more = bool(message.get("more_body", False))
            piece = message.get("body", b"")
            size, separators = size + len(piece), separators + piece.count(b",")
            if size > MAX_BODY_BYTES or separators > MAX_SEPARATORS:
                if more:
                    await drain(receive)
                raise HTTPException(413, TOO_MANY_BYTES if size > MAX_BODY_BYTES else TOO_MANY_VALUES)
            return message

        await self.app(scope, limited, send)


async def drain(receive: Receive) -> None:
    """Read and forget what is still coming, for DRAIN_S at most."""
    with anyio.move_on_after(DRAIN_S):
        more = True
        while more:
            message = await receive()
            more = message["type"] != "http.disconnect" and bool(message.get("more_body", False))
