"""The gate: who may not, gets no further, and nothing of his request is read before that is known."""

from __future__ import annotations

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.types import ASGIApp, Message, Receive, Send
from starlette.types import Scope as AsgiScope

from api.access import SCOPE_KEY, Access
from api.admission import Admission
from api.audit_trail import AuditTrail
from api.audited import CODE_KEY, entry_of, entry_of_crash, is_act, refusal_of
from api.body_limit import drain
from api.needed_scope import needed_scope
from api.problem_handlers import answer_error
from api.rate import rate_headers, require_allowance
from core.errors import IntegumentError
from store.disk_floor import DiskFloor
from store.rate_limit import Allowance, RateLimiter
from store.scope import Scope

BRING_WORK = frozenset({"POST", "PATCH", "PUT"})  # reading and removing go on where the disk is full


class Gate:
    """ASGI middleware between `api.request_context` and everything else: keys, the rate of the key's workspace, the
    disk, the audit log."""

    def __init__(self, app: ASGIApp, admission: Admission, limiter: RateLimiter, trail: AuditTrail, disk: DiskFloor) -> None:
        self.app = app
        self._disk = disk
        self._admission = admission
        self._limiter = limiter
        self._trail = trail

    async def __call__(self, scope: AsgiScope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http" or (need := needed_scope(scope["method"], scope["path"])) is None:
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        allowance: Allowance | None = None
        unnoted, scope[CODE_KEY] = is_act(scope), {}

        async def send_with_rate(message: Message) -> None:
            if message["type"] == "http.response.start" and allowance is not None:
                MutableHeaders(scope=message).update(rate_headers(allowance))
            await send(message)

        async def send_audited(message: Message) -> None:
            nonlocal unnoted
            if unnoted and message["type"] == "http.response.start":
                unnoted = False
                self._trail.note(entry_of(scope, message))  # before the client knows
            await send_with_rate(message)

        try:
            known = self._admission.admit_at_once(headers, need)
            if known is not None and known.key_id is None:  # whoever needs no key is alone on his machine: he is not counted
                access = known
            else:
                access, allowance = await run_in_threadpool(self._look, headers, need, known)
            scope[SCOPE_KEY] = access
            require_allowance(access, allowance)
            if scope["method"] in BRING_WORK:
                self._disk.require()
        except IntegumentError as error:
            key_id = error.facts.get("key")
            self._trail.note_refusal(refusal_of(scope, error.code, str(key_id) if key_id is not None else None))
            if "expect" not in headers:  # with 100-continue nothing is on its way; else a client in mid-sending sees no answer
                await drain(receive)
            await answer_error(Request(scope, receive), error)(scope, receive, send_with_rate)
            return
        try:
            await self.app(scope, receive, send_audited)
        except Exception:
            if unnoted:
                self._trail.note(entry_of_crash(scope))
            raise

    def _look(self, headers: Headers, need: Scope, found: Access | None) -> tuple[Access, Allowance | None]:
        """What may wait for database and Valkey, in one thread."""
        access = self._admission.admit(headers, need) if found is None else found
        return access, None if access.key_id is None else self._limiter.take(access.workspace)
