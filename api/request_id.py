"""The id that ties an answer, a log line and a user's report together."""

from __future__ import annotations

import re
import uuid

from starlette.requests import Request

HEADER = "X-Request-ID"
_ACCEPTED = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")


def choose_request_id(sent: str | None) -> str:
    """The caller's id if it is short and plain enough for a log line, else a new one."""
    return sent if sent is not None and _ACCEPTED.fullmatch(sent) else uuid.uuid4().hex


def request_id_of(request: Request) -> str:
    """The id `api.request_context` gave this request."""
    return str(request.scope["request_id"])
