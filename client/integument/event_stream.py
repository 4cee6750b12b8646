"""Server-sent events: reading the wire form (WHATWG HTML, 9.2.6)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

# only these end a line; str.splitlines would also cut at U+2028, which JSON may hold bare
_LINE_END = re.compile(rb"\r\n|\n|\r")


@dataclass(frozen=True, slots=True)
class Message:
    """One dispatched event."""

    id: str
    type: str
    data: str


@dataclass(slots=True)
class EventStreamParser:
    """Fed with pieces of any size; `last_id`, of the last complete event, and `retry_s` are what a reconnect needs."""

    last_id: str = ""
    retry_s: float | None = None
    _rest: bytes = b""
    _id: str | None = None
    _type: str = ""
    _data: list[str] = field(default_factory=list)

    def feed(self, piece: bytes) -> Iterator[Message]:
        """The events completed by this piece. An event cut off by the end of the stream is never dispatched."""
        text = self._rest + piece
        # a CR at the very end may be the first half of CR LF
        usable = text[:-1] if text.endswith(b"\r") else text
        *lines, last = _LINE_END.split(usable)
        self._rest = last + text[len(usable) :]
        for line in lines:
            message = self._take(line.decode("utf-8", "replace"))
            if message is not None:
                yield message

    def _take(self, line: str) -> Message | None:
        if not line:
            return self._dispatch()
        name, _, value = line.removeprefix("\ufeff").partition(":")
        value = value.removeprefix(" ")
        if name == "data":
            self._data.append(value)
        elif name == "event":
            self._type = value
        elif name == "id" and "\0" not in value:
            self._id = value
        elif name == "retry" and value.isdecimal():
            self.retry_s = int(value) / 1000
        return None

    def _dispatch(self) -> Message | None:
        data, event_type = self._data, self._type
        self._data, self._type = [], ""
        self.last_id = self.last_id if self._id is None else self._id
        return Message(self.last_id, event_type or "message", "\n".join(data)) if data else None
