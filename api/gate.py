"""The gate: who may not, gets no further, and nothing of his request is read before that is known."""

from __future__ import annotations

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.types import ASGIApp, Receive, Scope, Send

from api.access import SCOPE_KEY
from api.admission import Admission
from api.body_limit import drain
from api.needed_scope import needed_scope
from api.problem_handlers import answer_error
from core.errors import IntegumentError


class Gate:
    """ASGI middleware between `api.request_context` and everything else."""

    def __init__(self, app: ASGIApp, admission: Admission) -> None:
        self.app = app
        self._admission = admission

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or (need := needed_scope(scope["method"], scope["path"])) is None:
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        try:
            scope[SCOPE_KEY] = await run_in_threadpool(self._admission.admit, headers, need)
        except IntegumentError as error:
            if "expect" not in headers:  # with 100-continue nothing is on its way; else a client in mid-sending sees no answer
                await drain(receive)
            await answer_error(Request(scope, receive), error)(scope, receive, send)
            return
        await self.app(scope, receive, send)
