"""The rate of requests, as clients are told of it (draft-ietf-httpapi-ratelimit-headers-10, RFC 6585)."""

from __future__ import annotations

from api.access import Access
from core.errors import LimitError
from store.rate_limit import Allowance

POLICY = '"workspace"'


def rate_headers(allowance: Allowance) -> dict[str, str]:
    """`RateLimit-Policy`: q requests in w seconds; `RateLimit`: r are left, and all again in t seconds."""
    return {
        "RateLimit-Policy": f"{POLICY};q={allowance.burst};w={allowance.window_s}",
        "RateLimit": f"{POLICY};r={allowance.remaining};t={allowance.reset_s}",
    }


def require_allowance(access: Access, allowance: Allowance | None) -> None:
    """Raises LimitError `rate.exceeded`."""
    if allowance is not None and not allowance.allowed:
        raise LimitError(
            "rate.exceeded",
            f"workspace {access.workspace} sends more than {allowance.per_s:g} requests per second, with {allowance.burst} at "
            f"once; try again in {allowance.retry_after_s} s",
            per_s=allowance.per_s,
            burst=allowance.burst,
            retry_after_s=allowance.retry_after_s,
        )
