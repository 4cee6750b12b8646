"""One line and one count per request, whatever becomes of it."""

from __future__ import annotations

import logging
import time

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.access import SCOPE_KEY, Access
from api.audited import CODE_KEY
from api.http_tally import HttpTally
from api.links import BASE
from sandbox.log_lines import add_log_context, log_context
from store.telemetry import Span, span

QUIET_PATHS = frozenset({"/healthz", "/readyz", "/metrics"})  # asked every few seconds; only their failures are worth a line
CUT_OFF = 499  # the client went, or the server failed, before an answer began

lines = logging.getLogger("integument.requests")


class RequestLog:
    """ASGI middleware around everything else."""

    def __init__(self, app: ASGIApp, tally: HttpTally) -> None:
        self.app = app
        self._tally = tally

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        began = time.perf_counter()
        status, answered_s = CUT_OFF, None
        scope[CODE_KEY] = {}

        async def send_noting(message: Message) -> None:
            nonlocal status, answered_s
            if message["type"] == "http.response.start":
                status, answered_s = message["status"], time.perf_counter() - began
            await send(message)

        parent = Headers(scope=scope).get("traceparent")
        with log_context(), span(scope["method"][:10], parent=parent, server=True) as traced:
            add_log_context(**({} if traced.trace_id is None else {"trace_id": traced.trace_id}))
            try:
                await self.app(scope, receive, send_noting)
            finally:
                whole_s = time.perf_counter() - began
                self._note(scope, status, whole_s if answered_s is None else answered_s, whole_s)
                _describe(traced, scope, status)

    def _note(self, scope: Scope, status: int, answered_s: float, whole_s: float) -> None:
        code: str | None = scope[CODE_KEY].get("code")
        route = _template(scope)
        access: Access | None = scope.get(SCOPE_KEY)
        self._tally.note(scope["method"], route, status, answered_s, code)
        level = logging.DEBUG if scope["path"] in QUIET_PATHS and status < 400 else logging.INFO
        if lines.isEnabledFor(level):
            fields = {
                "method": scope["method"][:10],
                "path": scope["path"][:500],  # without the query
                "status": status,
                "seconds": round(whole_s, 4),
                "code": code,
                "workspace": None if access is None else access.workspace,
                "key": None if access is None else access.key_id,
            }
            told = {name: value for name, value in fields.items() if value is not None}
            message = "%s %s %d in %.3f s"
            extra = {"event": "http_request", "fields": told}
            lines.log(level, message, fields["method"], fields["path"], status, whole_s, extra=extra)


def _describe(traced: Span, scope: Scope, status: int) -> None:
    route = _template(scope)
    traced.rename(f"{scope['method'][:10]} {route}" if route else scope["method"][:10])
    traced.note(http__request__method=scope["method"][:10], http__route=route, http__response__status_code=status)
    traced.note(integument__request_id=scope.get("request_id"))
    if status >= 500:
        traced.fail(str(scope[CODE_KEY].get("code", status)))


def _template(scope: Scope) -> str | None:
    """`/v1/meshes/{mesh_id}`; None where no route was found. The framework leaves out what all routes of a router share."""
    template: str | None = getattr(scope.get("route"), "path", None)
    if template is not None and scope["path"].startswith(f"{BASE}/") and not template.startswith(f"{BASE}/"):
        return BASE + template
    return template
