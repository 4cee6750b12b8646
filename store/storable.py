"""Make any message of a child process fit to be stored: a log line must never make the write of a result fail."""

from __future__ import annotations

import math
from typing import Any

MAX_TEXT = 8_000


def storable_text(text: str, limit: int = MAX_TEXT) -> str:
    """Without NUL and lone surrogates, which PostgreSQL refuses, and cut to `limit` characters."""
    clean = text.replace("\x00", "\ufffd").encode("utf-8", "replace").decode("utf-8")
    return clean if len(clean) <= limit else clean[: limit - 1] + "…"


def storable(value: Any) -> Any:
    """The same for JSON; NaN and infinity, which JSON does not have, become their names."""
    if isinstance(value, str):
        return storable_text(value)
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {storable_text(str(key)): storable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [storable(item) for item in value]
    return value
