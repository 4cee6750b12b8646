"""The SHA-256 a server states for a download."""

from __future__ import annotations

import base64
import binascii
import re

import httpx

_STRONG_SHA256 = re.compile(r'^"(?:sha-?256[:=-])?([0-9a-f]{64})"$')
_REPR_DIGEST = re.compile(r"(?:^|,)\s*sha-256=:([A-Za-z0-9+/=]+):")


def stated_sha256(headers: httpx.Headers) -> str | None:
    """Hex, from Repr-Digest (RFC 9530: of the whole file, also on a 206) or from a strong ETag that is a SHA-256."""
    match = _REPR_DIGEST.search(headers.get("repr-digest", ""))
    if match:
        try:
            return base64.b64decode(match[1], validate=True).hex()
        except binascii.Error:
            return None
    return sha256_of_etag(headers.get("etag", ""))


def sha256_of_etag(etag: str) -> str | None:
    """Hex; None for weak ETags and those that are something else."""
    match = _STRONG_SHA256.match(etag)
    return match[1] if match else None
