"""The outermost layer: request id, Host check, security headers, and an answer even when everything inside fails."""

from __future__ import annotations

import re
from collections.abc import Iterable

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.problem_handlers import on_unexpected
from api.problems import describe_problem, problem_response
from api.request_id import HEADER, choose_request_id
from sandbox.log_lines import add_log_context

LOOPBACK_HOSTS = frozenset({"127.0.0.1", "localhost", "[::1]"})
ANY_HOST = "*"
_HARMLESS = frozenset({"GET", "HEAD", "OPTIONS"})
_HOST = re.compile(r"(?P<name>\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]+)(:\d{1,5})?")

SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "X-Frame-Options": "DENY",
}


class RequestContext:
    """ASGI middleware around the whole application.

    The Origin check stops pages of other servers that post a form here: a browser tells whose page it was, other clients tell
    nothing. The Host check stops web pages that rebind their DNS name to this machine: a browser sends their name, not ours."""

    def __init__(self, app: ASGIApp, allowed_hosts: Iterable[str]) -> None:
        self.app = app
        self.allowed_hosts = frozenset(host.lower() for host in allowed_hosts)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        scope["request_id"] = choose_request_id(headers.get(HEADER))
        add_log_context(request_id=scope["request_id"])
        started = False

        async def send_with_headers(message: Message) -> None:
            nonlocal started
            if message["type"] == "http.response.start":
                started = True
                answer = MutableHeaders(scope=message)
                answer[HEADER] = scope["request_id"]
                for name, value in SECURITY_HEADERS.items():
                    answer.setdefault(name, value)
            await send(message)

        request = Request(scope, receive)
        if not scope.get("query_string", b"").isascii():
            scope["query_string"] = b""  # or nothing could say where the request went
            await _refuse_query(request)(scope, receive, send_with_headers)
            return
        if not self._is_allowed(headers.getlist("host")):
            await self._refuse(request)(scope, receive, send_with_headers)
            return
        if scope["method"] not in _HARMLESS and not _is_ours(headers):
            await self._refuse_origin(request)(scope, receive, send_with_headers)
            return
        try:
            await self.app(scope, receive, send_with_headers)
        except Exception as error:
            if started:
                raise  # half an answer is out: the server must cut the connection
            await on_unexpected(request, error)(scope, receive, send_with_headers)

    def _is_allowed(self, hosts: list[str]) -> bool:
        if ANY_HOST in self.allowed_hosts:
            return len(hosts) == 1
        match = _HOST.fullmatch(hosts[0]) if len(hosts) == 1 else None
        return match is not None and match["name"].lower() in self.allowed_hosts

    def _refuse_origin(self, request: Request) -> ASGIApp:
        sent = request.headers.get("origin", "none")
        return problem_response(
            describe_problem(
                request,
                code="request.origin_refused",
                status=403,
                detail=f"A page of {sent[:100]!r} sent this request; pages of other servers may not act on this one",
            )
        )

    def _refuse(self, request: Request) -> ASGIApp:
        sent = request.headers.get("host", "none")
        return problem_response(
            describe_problem(
                request,
                code="request.host_refused",
                status=400,
                detail=f"This server does not answer to the host name {sent[:100]!r}; allow it with INTEGUMENT_ALLOWED_HOSTS",
            )
        )


def _refuse_query(request: Request) -> ASGIApp:
    detail = "The query has bytes beyond ASCII; percent-encode them (RFC 3986)"
    return problem_response(describe_problem(request, code="request.malformed", status=400, detail=detail))


def _is_ours(headers: Headers) -> bool:
    """True unless a browser says that the page of another server, or of none (`null`), is behind the request."""
    origin = headers.get("origin")
    return origin is None or origin.partition("://")[2].lower() == headers["host"].lower()
