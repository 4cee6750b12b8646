"""The header `Accept`, as far as two representations need it."""

from __future__ import annotations


def prefers(accept: str | None, wanted: str, default: str) -> bool:
    """True if the client likes `wanted` better than `default`; what it says nothing about is the default."""
    return accept is not None and _quality(accept, wanted) > _quality(accept, default)


def _quality(accept: str, media_type: str) -> float:
    """The q of the most specific range that matches (RFC 9110 12.5.1); 0 if none does or it cannot be read."""
    best, quality = -1, 0.0
    for part in accept.split(","):
        name, *parameters = (piece.strip().lower() for piece in part.split(";"))
        for specificity, pattern in enumerate(("*/*", media_type.split("/")[0] + "/*", media_type)):
            if name == pattern and specificity > best:
                best, quality = specificity, _q(parameters)
    return quality


def _q(parameters: list[str]) -> float:
    for parameter in parameters:
        name, _, value = parameter.partition("=")
        if name.strip() == "q":
            try:
                return min(max(float(value), 0.0), 1.0)
            except ValueError:
                return 0.0
    return 1.0
