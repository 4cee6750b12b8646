"""Secrets callbacks are signed with, in the form of Standard Webhooks: `whsec_` and base64 of 24 to 64 random bytes."""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac

from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

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


def workspace_secret(secret: str, workspace: WorkspaceId) -> str:
    """What the receivers of a workspace verify with: derived, so nothing is stored, and no receiver can forge for another.

    `default` is the operator's and verifies with the server's secret itself, from which all others follow."""
    if workspace == DEFAULT_WORKSPACE:
        return secret
    derived = hmac.digest(secret_bytes(secret), b"integument callbacks of " + workspace.encode(), hashlib.sha256)
    return SECRET_PREFIX + base64.b64encode(derived).decode()
