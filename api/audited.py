"""Which requests leave an entry in the audit log, and what it says."""

from __future__ import annotations

import re
from datetime import UTC, datetime

from starlette.datastructures import Headers
from starlette.types import Message, Scope

from api.access import SCOPE_KEY, Access
from api.needed_scope import UPLOADS
from store.audit import DONE, AuditEntry

CODE_KEY = "problem_code"  # of ASGI's scope: a dict that survives its copies
_READING = frozenset({"GET", "HEAD", "OPTIONS"})
_ID = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")


def is_act(scope: Scope) -> bool:
    """Reading leaves no trace; pieces of an upload neither: its announcement does, and the mesh made of it."""
    piece_of_upload = scope["method"] == "PATCH" and scope["path"].startswith(f"{UPLOADS}/")
    return scope["method"] not in _READING and not piece_of_upload


def entry_of(scope: Scope, start: Message) -> AuditEntry:
    """What the answer, of which `start` is the beginning, tells of the request."""
    headers = Headers(raw=start.get("headers", []))
    status: int = start["status"]
    if status >= 400:
        return _entry(scope, scope["path"], str(scope[CODE_KEY].get("code", f"http.{status}")))
    return _entry(scope, headers.get("location", scope["path"]), DONE)


def entry_of_crash(scope: Scope) -> AuditEntry:
    """No answer came."""
    return _entry(scope, scope["path"], "internal.unexpected")


def refusal_of(scope: Scope, code: str, key_id: str | None) -> AuditEntry:
    """Turned away at the gate."""
    return _entry(scope, scope["path"], code, key_id)


def _entry(scope: Scope, subject: str, outcome: str, key_id: str | None = None) -> AuditEntry:
    access: Access | None = scope.get(SCOPE_KEY)
    if access is not None:
        key_id = access.key_id
    return AuditEntry(
        at=datetime.now(UTC),
        actor="unknown" if access is None else "key" if access.key_id is not None else "loopback",
        key_id=key_id,
        workspace=None if access is None else access.workspace,
        action=f"{scope['method'][:10]} {_ID.sub('{id}', scope['path'])}",
        subject=subject,
        outcome=outcome,
        request_id=scope["request_id"],
    )
