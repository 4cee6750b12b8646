"""Runs the parts: one thread, one selector over their output, their ends and our signals. Nothing here polls."""

from __future__ import annotations

import os
import selectors
import signal
import time
from collections.abc import Callable
from contextlib import suppress

import psutil

from core.errors import InternalError
from server.part import Part, describe_exit
from server.stop_signals import StopSignals
from server.tether import adopt_orphans

IDLE_S = 3600.0


class Supervisor:
    """Keeps parts alive: a crashed part is started again with back-off, and given up by name after too many crashes."""

    def __init__(self, signals: StopSignals, announce: Callable[[str], None], on_crash: Callable[[Part], None]) -> None:
        """`on_crash` is called after a part died by itself and before it is started again."""
        self._signals = signals
        self._announce = announce
        self._on_crash = on_crash
        self._parts: list[Part] = []
        self._selector = selectors.DefaultSelector()
        self._selector.register(signals.wakeup_fd, selectors.EVENT_READ, None)
        self._strangers = {child.pid for child in psutil.Process().children()}
        adopt_orphans(True)

    def start(self, part: Part) -> None:
        """Raises: InternalError `server.part_not_started`."""
        if part not in self._parts:
            self._parts.append(part)
        try:
            part.start()
        except OSError as error:
            raise InternalError(
                "server.part_not_started", f"The {part.name} could not be started: {error}.", part=part.name
            ) from error
        self._selector.register(part.output_fd, selectors.EVENT_READ, part)
        self._selector.register(part.pid_fd, selectors.EVENT_READ, part)

    def run(self, seconds: float | None = None) -> bool:
        """Serve for so long (None: until asked to stop). True: asked to stop. Raises: InternalError `server.part_crashed`."""
        deadline = time.monotonic() + (IDLE_S if seconds is None else seconds)
        while not self._signals.stop_asked:
            now = time.monotonic()
            if seconds is not None and now >= deadline:
                return False
            starts = [part.restart_at_s for part in self._parts if part.restart_at_s is not None]
            self._turn(min([*starts, deadline if seconds is not None else now + IDLE_S]) - now)
            for part in self._parts:
                if part.restart_at_s is not None and part.restart_at_s <= time.monotonic():
                    self.start(part)
        return True

    def stop(self) -> None:
        """SIGTERM to one part after the other, last started first, SIGKILL after its grace or at a second Ctrl-C."""
        for part in reversed(self._parts):
            part.restart_at_s = None
            part.signal(signal.SIGTERM)
            deadline = time.monotonic() + part.program.grace_s
            while part.process is not None and time.monotonic() < deadline and not self._signals.stop_at_once:
                self._turn(deadline - time.monotonic(), stopping=True)
            if part.process is not None:
                self._announce(f"The {part.name} did not stop in time and is killed.")
                part.signal(signal.SIGKILL)
                while part.process is not None:
                    self._turn(IDLE_S, stopping=True)
        self._end_orphans()
        adopt_orphans(False)
        for part in self._parts:
            part.log.close()
        self._selector.close()

    def _turn(self, timeout_s: float, *, stopping: bool = False) -> None:
        """Wait for one round of events and answer them."""
        ended: list[Part] = []
        for key, _ in self._selector.select(max(0.0, timeout_s)):
            part: Part | None = key.data
            if part is None:
                self._signals.drain()
                self._reap_orphans()
            elif part.process is None:
                continue
            elif key.fd == part.pid_fd:
                ended.append(part)
            elif not part.copy_output():
                self._selector.unregister(key.fd)
        for part in ended:
            self._end(part, stopping=stopping)

    def _end(self, part: Part, *, stopping: bool) -> None:
        self._selector.unregister(part.pid_fd)
        with suppress(KeyError):  # its output may have ended before
            self._selector.unregister(part.output_fd)
        code = part.collect()
        if stopping or self._signals.stop_asked:
            return
        wait_s = part.backoff.after_crash(time.monotonic())
        if wait_s is None:
            policy = part.backoff.policy
            raise InternalError(
                "server.part_crashed",
                f"The {part.name} ended by itself {policy.crashes} times within {policy.window_s:.0f} s, "
                f"last with {describe_exit(code)}. The end of {part.log.path}:\n{part.log.tail()}",
                part=part.name,
                crashes=policy.crashes,
            )
        self._announce(f"The {part.name} ended with {describe_exit(code)}; starting it again in {wait_s:.1f} s.")
        self._on_crash(part)
        part.restart_at_s = time.monotonic() + wait_s

    def _reap_orphans(self) -> None:
        """Take note of the ends of adopted processes; those of the parts are left to `collect`."""
        for orphan in self._orphans():
            os.waitpid(orphan.pid, os.WNOHANG)

    def _end_orphans(self) -> None:
        """Kill what the parts left behind, however deep; children of the killed are adopted and killed in the next round."""
        while orphans := self._orphans():
            for orphan in orphans:
                orphan.kill()
            for orphan in orphans:
                os.waitpid(orphan.pid, 0)

    def _orphans(self) -> list[psutil.Process]:
        """Our children that are neither parts nor older than the supervisor."""
        parts = {part.process.pid for part in self._parts if part.process is not None}
        return [child for child in psutil.Process().children() if child.pid not in parts | self._strangers]
