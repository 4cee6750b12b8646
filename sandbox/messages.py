"""What a child says: one JSON object per line, bounded, read without ever blocking the parent."""

from __future__ import annotations

import json
from typing import Any

MAX_LINE_BYTES = 32 * 1024**2  # a result with all its findings; far above anything a process returns
Message = dict[str, Any]


class BrokenMessageError(ValueError):
    """A line longer than MAX_LINE_BYTES, or one that is no JSON object: the child cannot be trusted any more."""


def encode(message: Message) -> bytes:
    """One line; raises ValueError for NaN, infinity and anything JSON has no word for."""
    return json.dumps(message, allow_nan=False, separators=(",", ":")).encode() + b"\n"


class LineReader:
    """Puts the pieces that a pipe delivers back together; holds at most one unfinished line."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []
        self._held = 0

    def feed(self, data: bytes) -> list[Message]:
        """The messages that `data` completes, in order; raises BrokenMessageError."""
        *complete, rest = data.split(b"\n")
        messages = []
        for line in complete:
            messages.append(_decode(b"".join([*self._pieces, line])))
            self._pieces, self._held = [], 0
        if rest:
            self._pieces.append(rest)
            self._held += len(rest)
        if self._held > MAX_LINE_BYTES:
            raise BrokenMessageError(f"a message of more than {MAX_LINE_BYTES} bytes")
        return messages


def _decode(line: bytes) -> Message:
    try:
        message = json.loads(line)
    except (ValueError, RecursionError) as error:  # the latter: nested without end
        raise BrokenMessageError(f"a message that is no JSON: {error}") from error
    if not isinstance(message, dict):
        raise BrokenMessageError("a message that is no JSON object")
    return message
