"""SIGINT, SIGTERM and SIGHUP as events of a selector."""

from __future__ import annotations

import signal
import socket
from types import FrameType, TracebackType

STOP = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class StopSignals:
    """While entered: the first stop signal asks for an orderly end, the second for one at once. Main thread only."""

    def __init__(self) -> None:
        """Nothing is changed before `__enter__`."""
        self._count = 0

    @property
    def stop_asked(self) -> bool:
        """One signal came."""
        return self._count > 0

    @property
    def stop_at_once(self) -> bool:
        """Two came."""
        return self._count > 1

    @property
    def wakeup_fd(self) -> int:
        """Becomes readable with every signal, SIGCHLD among them."""
        return self._reader.fileno()

    def drain(self) -> None:
        """Make `wakeup_fd` silent again."""
        while True:
            try:
                self._reader.recv(4096)
            except BlockingIOError:
                return

    def __enter__(self) -> StopSignals:
        """Raises: ValueError outside the main thread."""
        self._reader, self._writer = socket.socketpair()
        self._reader.setblocking(False)
        self._writer.setblocking(False)
        self._old_fd = signal.set_wakeup_fd(self._writer.fileno(), warn_on_full_buffer=False)
        self._old = {number: signal.getsignal(number) for number in (*STOP, signal.SIGCHLD)}
        for number in STOP:
            if number is not signal.SIGHUP or self._old[number] is not signal.SIG_IGN:  # nohup means: outlive the terminal
                signal.signal(number, self._note)
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)  # ignored by default, then it would not wake us
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        for number, handler in self._old.items():
            signal.signal(number, handler)
        signal.set_wakeup_fd(self._old_fd)
        self._reader.close()
        self._writer.close()

    def _note(self, _number: int, _frame: FrameType | None) -> None:
        self._count += 1
