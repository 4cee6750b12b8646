"""The API key of this user: a header of every request, never part of an address."""

from __future__ import annotations

import os
import re
from pathlib import Path

from integument.errors import ArgumentError

VARIABLE = "INTEGUMENT_API_KEY"
_FORM = re.compile(r"[0-9A-Za-z_-]{1,200}")


def authorization(api_key: str | None) -> dict[str, str]:
    """The header that carries the key; none without a key. Raises: ArgumentError if it cannot be one."""
    if not api_key:
        return {}
    if not _FORM.fullmatch(api_key):
        raise ArgumentError("the API key has characters no key has; was the whole file or line meant?")
    return {"Authorization": f"Bearer {api_key}"}


def key_of_environment() -> str | None:
    """INTEGUMENT_API_KEY, if it is set."""
    return os.environ.get(VARIABLE, "").strip() or None


def read_key_file(path: Path) -> str:
    """The key in a file: its text without the white space around it. Raises: ArgumentError."""
    try:
        key = path.read_text(encoding="ascii").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise ArgumentError(f"cannot read the key file {path}: {getattr(error, 'strerror', None) or 'it is no text'}") from error
    if not key:
        raise ArgumentError(f"the key file {path} is empty")
    return key
