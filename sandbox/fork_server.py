"""The nursery's own loop: one thread, one child per request, forked ahead of it, every child reaped and reported."""

from __future__ import annotations

import json
import logging
import os
import resource
import select
import selectors
import signal
import socket
import time
from dataclasses import dataclass
from typing import Any

from sandbox.descendants import children_of
from sandbox.leisure import Leisure
from sandbox.request import MAX_REQUEST_BYTES
from sandbox.spare import Spare, fork_spare

logger = logging.getLogger(__name__)

ORPHAN_PATIENCE_S = 2.0  # a killed orphan that the kernel cannot end (disk wait) does not hold back its parent's report longer
END_PATIENCE_S = 5.0


@dataclass
class Ward:
    """One child: `status` is the socket of its handle in the owner; `report` is set once it has been reaped."""

    pid: int
    status: socket.socket
    report: dict[str, Any] | None = None
    ended_at: float = 0.0


class ForkServer:
    """Serves one owner until the owner's end of the socket closes; then everything dies."""

    def __init__(self, owner: socket.socket, refusal: dict[str, Any] | None, leisure: Leisure) -> None:
        """`refusal`: the described error every request gets when the preload failed; `leisure`: what is done between requests."""
        self._owner = owner
        self._refusal = refusal
        self._leisure = leisure
        self._spare: Spare | None = None
        self._wards: dict[int, Ward] = {}
        self._departed: list[Ward] = []
        self._selector = selectors.DefaultSelector()

    def serve(self) -> None:
        """Until the owner goes."""
        wake_read, wake_write = socket.socketpair()
        for end in (wake_read, wake_write):
            end.setblocking(False)
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
        signal.set_wakeup_fd(wake_write.fileno(), warn_on_full_buffer=False)
        self._selector.register(self._owner, selectors.EVENT_READ)
        self._selector.register(wake_read, selectors.EVENT_READ)
        self._lay_in_spare()
        while True:
            ready = self._selector.select(self._patience_s())
            if not ready and self._leisure.is_due:
                self._use_leisure()
            for key, _ in ready:
                if key.fileobj is self._owner:
                    if not self._accept():
                        self._end()
                        return
                elif key.fileobj is wake_read:
                    wake_read.recv(4096)
                else:  # the handle asked for the end of its child, or was dropped
                    self._kill(key.data)
            self._reap()

    def _patience_s(self) -> float | None:
        if self._leisure.is_due:
            return 0.0  # whoever asks comes first
        return 0.1 if self._departed else None

    def _use_leisure(self) -> None:
        """One step; after the last one the next child shall have all of it."""
        self._leisure.take_step()
        if not self._leisure.is_due:
            self._dismiss_spare()
            self._lay_in_spare()

    def _accept(self) -> bool:
        """Take one request and fork; False once the owner is gone."""
        try:
            datagram, descriptors, _, _ = socket.recv_fds(self._owner, MAX_REQUEST_BYTES, 3, socket.MSG_CMSG_CLOEXEC)
        except ConnectionResetError:  # gone, with our "ready" unread
            return False
        if not datagram:
            return False
        events, payload, status_fd = descriptors
        status = socket.socket(fileno=status_fd)
        try:
            if self._refusal is not None:
                _tell(status, {"refused": self._refusal})
                status.close()
            else:
                self._place(datagram, events, payload, status)
        finally:
            os.close(events)
            os.close(payload)
        self._lay_in_spare()
        return True

    def _place(self, datagram: bytes, events: int, payload: int, status: socket.socket) -> None:
        try:
            pid = self._hand_over(datagram, events, payload)
        except OSError as error:  # no memory, or too many processes
            _tell(
                status,
                {"refused": {"code": "nursery.fork_failed", "fault": "internal", "message": f"cannot start a child: {error}"}},
            )
            status.close()
            return
        ward = Ward(pid, status)
        self._wards[pid] = ward
        self._selector.register(status, selectors.EVENT_READ, ward)
        _tell(status, {"pid": pid})

    def _hand_over(self, datagram: bytes, events: int, payload: int) -> int:
        """Process id of the child that has it: the spare one, or another if there is none or it died while it waited."""
        if self._spare is not None:
            spare, self._spare = self._spare, None
            if spare.give(datagram, events, payload):
                return spare.pid
        spare = fork_spare()
        if not spare.give(datagram, events, payload):
            raise ChildProcessError("it died at once")
        return spare.pid

    def _lay_in_spare(self) -> None:
        """After a request, so that the fork is nobody's time; where it fails, the next request tries again and hears why."""
        if self._spare is not None or self._refusal is not None:
            return
        try:
            self._spare = fork_spare()
        except OSError as error:
            logger.warning("no child can be forked ahead: %s", error)

    def _dismiss_spare(self) -> None:
        if self._spare is not None:
            self._spare.dismiss()
            self._spare = None

    def _kill(self, ward: Ward) -> None:
        """End a child and its process group; those who left the group come to us as orphans."""
        self._selector.unregister(ward.status)
        if ward.report is not None:
            return
        for kill in (os.kill, os.killpg):  # it may not have its own session yet
            try:
                kill(ward.pid, signal.SIGKILL)
            except ProcessLookupError:
                continue

    def _reap(self) -> None:
        """Collect the dead, kill what they left behind, then report: once the owner hears of an end, nothing of it runs."""
        while (ended := _next_dead()) is not None:
            pid, status, usage = ended
            if self._leisure.hear_of_end(pid):
                continue
            if self._spare is not None and pid == self._spare.pid:
                self._dismiss_spare()
            ward = self._wards.pop(pid, None)
            if ward is not None:  # else: an orphan we killed, or a spare child
                ward.report = {"exit_code": os.waitstatus_to_exitcode(status), "max_rss_bytes": usage.ru_maxrss * 1024}
                ward.ended_at = time.monotonic()
                self._departed.append(ward)
        if self._departed:
            orphans = [pid for pid in children_of(os.getpid()) if pid not in self._wards and pid not in self._own()]
            for pid in orphans:
                os.kill(pid, signal.SIGKILL)
            latest = time.monotonic() - ORPHAN_PATIENCE_S
            ready = [ward for ward in self._departed if not orphans or ward.ended_at < latest]
            for ward in ready:
                self._departed.remove(ward)
                self._dismiss(ward)

    def _own(self) -> set[int]:
        """Children of ours that have no job."""
        return {pid for pid in (self._leisure.pid, None if self._spare is None else self._spare.pid) if pid is not None}

    def _dismiss(self, ward: Ward) -> None:
        if ward.status in self._selector.get_map():
            self._selector.unregister(ward.status)
        _tell(ward.status, ward.report or {})
        ward.status.close()

    def _end(self) -> None:
        """Kill everybody and wait for it, so that a restarted owner finds no leftovers."""
        self._dismiss_spare()
        self._leisure.end()
        for ward in list(self._wards.values()):
            if ward.status in self._selector.get_map():
                self._kill(ward)
        deadline = time.monotonic() + END_PATIENCE_S
        while children_of(os.getpid()) and time.monotonic() < deadline:
            self._selector.select(timeout=0.05)
            self._reap()


def _next_dead() -> tuple[int, int, resource.struct_rusage] | None:
    """Process id, wait status and use of a child that has ended; None if none has."""
    try:
        pid, status, usage = os.wait4(-1, os.WNOHANG)
    except ChildProcessError:
        return None
    return (pid, status, usage) if pid else None


def _tell(status: socket.socket, message: dict[str, Any]) -> None:
    try:
        status.send(json.dumps(message).encode(), socket.MSG_DONTWAIT)
    except OSError as error:  # the handle is gone: nobody wants to know
        logger.debug("no one listens for the end of a child: %s", error)


def owner_is_gone(owner: socket.socket) -> bool:
    """Whether the other end is closed, even while requests are still waiting to be read."""
    poll = select.poll()
    poll.register(owner, select.POLLRDHUP)
    return bool(poll.poll(0))
