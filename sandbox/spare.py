"""A child forked ahead of its job: it waits with nothing of anybody's in it, gets one job, and ends with that."""

from __future__ import annotations

import logging
import os
import signal
import socket
import sys
from dataclasses import dataclass
from typing import NoReturn

from sandbox.child_main import run_child
from sandbox.confinement import prepare_ahead, tie_to
from sandbox.request import MAX_REQUEST_BYTES, Request

logger = logging.getLogger("sandbox.nursery")

FIRST_FD = 3  # after the standard three


@dataclass(frozen=True, slots=True)
class Spare:
    """The nursery's end of one that waits. `desk`: where its job is handed in."""

    pid: int
    desk: socket.socket

    def give(self, datagram: bytes, events: int, payload: int) -> bool:
        """Hand it its job, an encoded Request; False if it is no more. It takes no second one."""
        with self.desk:
            try:
                socket.send_fds(self.desk, [datagram], [events, payload])
            except (BrokenPipeError, ConnectionResetError):
                return False
        return True

    def dismiss(self) -> None:
        """It ends by itself, without a job; the caller reaps it."""
        self.desk.close()


def fork_spare() -> Spare:
    """Raises OSError: no memory, or too many processes."""
    nursery_pid = os.getpid()
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    sys.stdout.flush()
    sys.stderr.flush()
    try:
        pid = os.fork()
    except OSError:
        ours.close()
        theirs.close()
        raise
    if pid == 0:
        _wait_for_job(theirs, nursery_pid)
    theirs.close()
    return Spare(pid, ours)


def forget_signals() -> None:
    """A copy of the nursery does not reap."""
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)


def _wait_for_job(desk: socket.socket, nursery_pid: int) -> NoReturn:
    """Does all that can be done before the job is known, then waits; never returns."""
    code = 1
    try:
        forget_signals()
        tie_to(nursery_pid)
        os.closerange(FIRST_FD, desk.fileno())
        os.closerange(desk.fileno() + 1, os.sysconf("SC_OPEN_MAX"))
        prepare_ahead()
        datagram, descriptors, _, _ = socket.recv_fds(desk, MAX_REQUEST_BYTES, 2, socket.MSG_CMSG_CLOEXEC)
        if datagram:
            events, payload = descriptors
            run_child(Request.decode(datagram), events, payload)
        code = 0  # it is not needed
    except BaseException:  # there is nobody above us
        logger.exception("a child ahead of its job cannot wait for it")
    finally:
        os._exit(code)
