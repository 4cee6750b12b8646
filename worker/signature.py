"""Signatures after Standard Webhooks: whoever has the secret can tell our callbacks from forged and from old ones."""

from __future__ import annotations

import base64
import hashlib
import hmac
from collections.abc import Iterable

from store.callback_secret import secret_bytes


def signature_headers(secrets: Iterable[str], message_id: str, timestamp_s: int, body: bytes) -> dict[str, str]:
    """`webhook-id`, `webhook-timestamp` and `webhook-signature` with one `v1` signature for each secret."""
    signed = b".".join((message_id.encode(), str(timestamp_s).encode(), body))
    digests = (hmac.digest(secret_bytes(secret), signed, hashlib.sha256) for secret in secrets)
    return {
        "webhook-id": message_id,
        "webhook-timestamp": str(timestamp_s),
        "webhook-signature": " ".join(f"v1,{base64.b64encode(digest).decode()}" for digest in digests),
    }
