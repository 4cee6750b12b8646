"""Make any message of a child process fit to be stored: a log line must never make the write of a result fail."""

from __future__ import annotations

import math
from typing import Any

MAX_TEXT = 8_000
MAX_DEPTH = 32


def storable_text(text: str, limit: int = MAX_TEXT) -> str:
    """Without NUL and lone surrogates, which PostgreSQL refuses, and cut to `limit` characters."""
    clean = text.replace("\x00", "\ufffd").encode("utf-8", "replace").decode("utf-8")
    return clean if len(clean) <= limit else clean[: limit - 1] + "…"


def storable(value: Any, depth: int = MAX_DEPTH) -> Any:
    """The same for JSON: NaN and infinity, which it does not have, become their names; what is nested too deep is cut."""
    if isinstance(value, str):
        return storable_text(value)
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if value is None or isinstance(value, bool | int | float):
        return value
    if not isinstance(value, dict | list | tuple):
        return storable_text(str(value))
    if depth == 0:
        return "…"
    if isinstance(value, dict):
        return {storable_text(str(key)): storable(item, depth - 1) for key, item in value.items()}
    return [storable(item, depth - 1) for item in value]
