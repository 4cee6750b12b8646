"""Secrets callbacks are signed with, in the form of Standard Webhooks: `whsec_` and base64 of 24 to 64 random bytes."""

from __future__ import annotations

import base64
import binascii

SECRET_PREFIX = "whsec_"  # noqa: S105 - not the secret
SECRET_BYTES = range(24, 65)


def secret_bytes(secret: str) -> bytes:
    """The key within. Raises ValueError, which does not repeat the secret."""
    try:
        key = base64.b64decode(secret.removeprefix(SECRET_PREFIX), validate=True)
    except (binascii.Error, ValueError):
        key = b""
    if not secret.startswith(SECRET_PREFIX) or len(key) not in SECRET_BYTES:
        raise ValueError(f"a callback secret is {SECRET_PREFIX} and the base64 of 24 to 64 bytes")
    return key
