"""The header `Authorization` (RFC 6750). A key travels nowhere else: URLs end in logs, histories and referrers."""

from __future__ import annotations

from starlette.datastructures import Headers

from core.errors import InputError

SCHEME = "bearer"


def read_bearer(headers: Headers) -> str:
    """The key that was sent. Raises InputError `access.key_missing`, `access.key_invalid`."""
    sent = headers.getlist("authorization")
    if not sent:
        raise InputError("access.key_missing", "This server asks for an API key: send `Authorization: Bearer itg_...`")
    scheme, _, key = sent[0].strip().partition(" ")
    if len(sent) > 1 or scheme.lower() != SCHEME or not key.strip():
        raise InputError("access.key_invalid", "The header Authorization is to be one: `Authorization: Bearer itg_...`")
    return key.strip()
