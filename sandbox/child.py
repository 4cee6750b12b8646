"""The owner's handle on one running child."""

from __future__ import annotations

import json
import os
import select
import socket
import time
from collections import deque
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

from sandbox.descendants import resident_bytes, with_descendants
from sandbox.limits import Limits
from sandbox.messages import BrokenMessageError, LineReader, Message
from sandbox.outcome import Outcome, conclude, protocol_broken

MAX_WAITING_EVENTS = 1000  # more stay in the pipe, and the child waits
READ_BYTES = 256 * 1024
CLOSE_PATIENCE_S = 10.0  # a SIGKILL that takes longer hangs in the kernel; its scratch folder is swept later


class Child:
    """Owns the event pipe and the status socket; letting go of it (`close`, `with`) ends the child. For one thread."""

    def __init__(self, pid: int, events: int, status: socket.socket, limits: Limits, scratch: Path) -> None:
        """Made by Nursery.spawn only."""
        self.pid = pid
        self.limits = limits
        self.scratch = scratch
        self.started_at = time.monotonic()
        os.set_blocking(events, False)
        self._events: int | None = events
        self._status = status
        self._reader = LineReader()
        self._waiting: deque[Message] = deque()
        self._last: Message | None = None
        self._ended = False
        self._report: Message | None = None
        self._outcome: Outcome | None = None
        self._broken: str | None = None
        self._peak_bytes = 0  # of the family, as far as anybody looked

    def events(self, timeout_s: float = 0.0) -> list[Message]:
        """What the child has said since the last call; waits up to `timeout_s` for it to say something or to end.

        A child whose events nobody reads waits once the pipe is full, so a parent must call this until there is an outcome."""
        if not self._waiting and self._outcome is None:
            self._listen(timeout_s)
        told = list(self._waiting)
        self._waiting.clear()
        return told

    def outcome(self) -> Outcome | None:
        """None while it runs, or while events it sent before its end have not been read."""
        if self._outcome is None:
            self._listen(0.0)
            if self._ended and self._events is None and not self._waiting:
                concluded = conclude(self._last, self._report, self.limits, self.scratch)
                concluded = replace(concluded, peak_bytes=max(concluded.peak_bytes, self._peak_bytes))
                if self._broken is not None:
                    concluded = replace(concluded, result=None, error=protocol_broken(self._broken), outputs=())
                self._outcome = concluded
        return self._outcome

    def memory_bytes(self) -> int:
        """Resident memory now, of the child and all its descendants; 0 once it has ended."""
        if self._ended:
            return 0
        present = sum(map(resident_bytes, with_descendants(self.pid)))
        self._peak_bytes = max(self._peak_bytes, present)
        return present

    @property
    def peak_bytes(self) -> int:
        """The most `memory_bytes` has seen."""
        return self._peak_bytes

    def kill(self) -> None:
        """SIGKILL to the child and everything it started; the outcome follows. Harmless when it has ended."""
        if not self._ended:
            try:
                self._status.shutdown(socket.SHUT_WR)
            except OSError:  # the nursery is gone, and its children with it
                return

    def close(self) -> None:
        """End the child if it still runs, wait until it is gone, and forget it."""
        self.kill()
        if not self._ended and select.select([self._status], [], [], CLOSE_PATIENCE_S)[0]:
            self._read_status()
        self._status.close()
        self._close_events()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _listen(self, timeout_s: float) -> None:
        """Wait on both ends at once and take what is there, at most one read each."""
        if self._ended:  # all it ever said is in the pipe
            self._read_events()
            return
        poll = select.poll()
        poll.register(self._status, select.POLLIN)
        if self._events is not None and len(self._waiting) < MAX_WAITING_EVENTS:
            poll.register(self._events, select.POLLIN)
        for descriptor, _ in poll.poll(timeout_s * 1000):
            if descriptor == self._events:
                self._read_events()
            else:
                self._read_status()

    def _read_events(self) -> None:
        if self._events is None or len(self._waiting) >= MAX_WAITING_EVENTS:
            return
        try:
            data = os.read(self._events, READ_BYTES)
        except BlockingIOError:  # only after the end, when an unkillable descendant holds the pipe open
            data = b""
        if not data:
            self._close_events()
            return
        try:
            for message in self._reader.feed(data):
                self._take(message)
        except BrokenMessageError as error:
            self._broken = str(error)
            self._close_events()
            self.kill()

    def _take(self, message: Message) -> None:
        if self._last is not None:
            raise BrokenMessageError("a message after the last one")
        if message.get("kind") in ("result", "error"):
            self._last = message
        else:
            self._waiting.append(message)

    def _read_status(self) -> None:
        try:
            datagram = self._status.recv(65536)
        except ConnectionResetError:  # the nursery died
            datagram = b""
        self._ended = True
        if datagram:
            self._report = json.loads(datagram)

    def _close_events(self) -> None:
        if self._events is not None:
            os.close(self._events)
            self._events = None
