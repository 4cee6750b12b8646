"""The nursery's own loop: one thread, one fork per request, every child reaped and reported."""

from __future__ import annotations

import json
import logging
import os
import select
import selectors
import signal
import socket
import sys
import time
from dataclasses import dataclass
from typing import Any

from sandbox.child_main import run_child
from sandbox.descendants import children_of
from sandbox.request import MAX_REQUEST_BYTES, Request

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

    def __init__(self, owner: socket.socket, refusal: dict[str, Any] | None) -> None:
        """`refusal`: the described error every request gets when the preload failed."""
        self._owner = owner
        self._refusal = refusal
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
        while True:
            for key, _ in self._selector.select(timeout=0.1 if self._departed else None):
                if key.fileobj is self._owner:
                    if not self._accept():
                        self._end()
                        return
                elif key.fileobj is wake_read:
                    wake_read.recv(4096)
                else:  # the handle asked for the end of its child, or was dropped
                    self._kill(key.data)
            self._reap()

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
                self._fork(Request.decode(datagram), events, payload, status)
        finally:
            os.close(events)
            os.close(payload)
        return True

    def _fork(self, request: Request, events: int, payload: int, status: socket.socket) -> None:
        nursery_pid = os.getpid()
        sys.stdout.flush()
        sys.stderr.flush()
        try:
            pid = os.fork()
        except OSError as error:  # no memory, or too many processes
            _tell(
                status,
                {"refused": {"code": "nursery.fork_failed", "fault": "internal", "message": f"cannot start a child: {error}"}},
            )
            status.close()
            return
        if pid == 0:
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            run_child(request, events, payload, nursery_pid)
        ward = Ward(pid, status)
        self._wards[pid] = ward
        self._selector.register(status, selectors.EVENT_READ, ward)
        _tell(status, {"pid": pid})

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
        while self._wards or self._departed:
            try:
                pid, status, usage = os.wait4(-1, os.WNOHANG)
            except ChildProcessError:
                break
            if pid == 0:
                break
            ward = self._wards.pop(pid, None)
            if ward is not None:  # else: an orphan we killed
                ward.report = {"exit_code": os.waitstatus_to_exitcode(status), "max_rss_bytes": usage.ru_maxrss * 1024}
                ward.ended_at = time.monotonic()
                self._departed.append(ward)
        if self._departed:
            orphans = [pid for pid in children_of(os.getpid()) if pid not in self._wards]
            for pid in orphans:
                os.kill(pid, signal.SIGKILL)
            latest = time.monotonic() - ORPHAN_PATIENCE_S
            ready = [ward for ward in self._departed if not orphans or ward.ended_at < latest]
            for ward in ready:
                self._departed.remove(ward)
                self._dismiss(ward)

    def _dismiss(self, ward: Ward) -> None:
        if ward.status in self._selector.get_map():
            self._selector.unregister(ward.status)
        _tell(ward.status, ward.report or {})
        ward.status.close()

    def _end(self) -> None:
        """Kill everybody and wait for it, so that a restarted owner finds no leftovers."""
        for ward in list(self._wards.values()):
            if ward.status in self._selector.get_map():
                self._kill(ward)
        deadline = time.monotonic() + END_PATIENCE_S
        while (self._wards or self._departed) and time.monotonic() < deadline:
            self._selector.select(timeout=0.05)
            self._reap()


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
