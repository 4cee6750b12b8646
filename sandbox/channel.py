"""The child's way to speak to whoever waits for it."""

from __future__ import annotations

import os
import threading

from sandbox.messages import Message, encode

RESERVED_KINDS = ("result", "error")  # the last message of a child; only sandbox.child_main sends them


class Channel:
    """Sends messages; blocks while the parent does not read, so a flood slows the child instead of filling the parent."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._lock = threading.Lock()

    def send(self, message: Message) -> None:
        """Send one event, e.g. {"kind": "progress", ...}; raises ValueError for a reserved kind or what JSON cannot say."""
        if message.get("kind") in RESERVED_KINDS:
            raise ValueError(f"kind {message['kind']!r} is reserved for the end of a child")
        self.send_last(message)

    def send_last(self, message: Message) -> None:
        """Send without looking at the kind."""
        line = memoryview(encode(message))
        with self._lock:
            while line:
                line = line[os.write(self._descriptor, line) :]
