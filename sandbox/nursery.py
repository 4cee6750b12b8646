"""The owner's side of the warm fork server.

A fresh interpreter with numpy, numba and the geometry libraries takes seconds to start; a fork of a process that has them takes
milliseconds. The nursery is such a process: it has one thread, holds nobody's data, and forks one limited child per call.
"""

from __future__ import annotations

import json
import logging
import os
import select
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from core.errors import InternalError
from sandbox.child import Child
from sandbox.limits import Limits
from sandbox.log_lines import LOG_FORMAT
from sandbox.outcome import revive
from sandbox.request import Request

logger = logging.getLogger(__name__)

THREAD_VARIABLES = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "NUMBA_NUM_THREADS")
# what a child may know of its host: no tokens, no addresses of databases
PASSED_VARIABLES = (
    *("PATH", "LD_LIBRARY_PATH", "PYTHONHASHSEED", "PYTHONDONTWRITEBYTECODE", "NUMBA_BOUNDSCHECK"),
    *("HOME", "TMPDIR", "XDG_CACHE_HOME", "MPLCONFIGDIR", "NUMBA_CACHE_DIR"),
    *("LANG", "LC_ALL", "LC_CTYPE", "TZ", LOG_FORMAT),
)
STOP_PATIENCE_S = 10.0


class Nursery:
    """Starts limited children; safe to use from several threads. Starts itself on the first spawn, and again if it died."""

    def __init__(
        self,
        preload: Sequence[str] = ("core.processes.registry",),
        threads: int = 1,
        ready_timeout_s: float = 300.0,
        *,
        require_confinement: bool = False,
    ) -> None:
        """`preload`: modules to import before the first fork, each with an optional `warm_up()`, and optional
        `leisure_steps()` for later; `threads`: per numeric pool;
        `require_confinement`: children that the kernel cannot lock in refuse to work (`confinement.missing`)."""
        self._preload = tuple(preload)
        self._threads = threads
        self._ready_timeout_s = ready_timeout_s
        self._require_confinement = require_confinement
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None

    @property
    def ready_timeout_s(self) -> float:
        """How long loading may take."""
        return self._ready_timeout_s

    @property
    def pid(self) -> int | None:
        """Of the nursery process; None while there is none."""
        return self._process.pid if self._process is not None else None

    def start(self) -> None:
        """Start loading; returns at once, the first spawn waits for the end of it."""
        with self._lock:
            self._ensure()

    def stop(self) -> None:
        """End it and every child; returns once they are gone."""
        with self._lock:
            self._discard()

    def wait_until_ready(self, timeout_s: float) -> bool:
        """True once the next spawn will be answered at once, be it with a refusal; starts the nursery if there is none."""
        with self._lock:
            control = self._ensure().dup()  # ours to look at, whatever another thread does with the original
        with control:
            return bool(select.select([control], [], [], timeout_s)[0])

    def spawn(
        self, target: str, payload: Mapping[str, Any], limits: Limits, scratch: Path, readable: Iterable[Path] = ()
    ) -> Child:
        """Fork a child that runs `target` ("module:function") on `payload` in the existing folder `scratch`.

        It can write there alone and read only that, the files and folders `readable`, and its own code.
        Raises InternalError: nursery.preload_failed, nursery.not_ready, nursery.fork_failed, nursery.lost."""
        inputs = tuple(str(path.absolute()) for path in readable)
        request = Request(target, limits, str(scratch.absolute()), inputs, self._require_confinement).encode()
        parcel = json.dumps(payload, allow_nan=False).encode()
        for _ in range(2):  # a nursery that died since the last call is replaced once
            status, events = self._ask(request, parcel)
            answer = self._wait_for_answer(status)
            if answer is not None and "pid" in answer:
                return Child(int(answer["pid"]), events, status, limits, scratch)
            status.close()
            os.close(events)
            if answer is not None:
                self.stop()  # it may be able to load what it needs next time
                raise revive(answer["refused"])
        raise InternalError("nursery.lost", "the process that starts the work died twice while it was asked to")

    def _ask(self, request: bytes, parcel: bytes) -> tuple[socket.socket, int]:
        """Send one request; our ends of the status socket and of the event pipe."""
        status, their_status = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        events, their_events = os.pipe()
        payload = os.memfd_create("payload")
        try:
            with os.fdopen(os.dup(payload), "wb") as writer:
                writer.write(parcel)
            self._send(request, [their_events, payload, their_status.fileno()])
        except BaseException:
            status.close()
            os.close(events)
            raise
        finally:
            their_status.close()
            os.close(their_events)
            os.close(payload)
        return status, events

    def _send(self, request: bytes, descriptors: list[int]) -> None:
        with self._lock:
            control = self._ensure()
            try:
                socket.send_fds(control, [request], descriptors)
            except (BrokenPipeError, ConnectionResetError):  # it died between the look and the call
                self._discard()
                socket.send_fds(self._ensure(), [request], descriptors)

    def _wait_for_answer(self, status: socket.socket) -> dict[str, Any] | None:
        """{"pid": …} or {"refused": …}; None when the nursery died first."""
        poll = select.poll()
        poll.register(status, select.POLLIN)
        if not poll.poll(self._ready_timeout_s * 1000):
            status.close()
            self.stop()
            raise InternalError(
                "nursery.not_ready",
                f"the processes were not loaded within {self._ready_timeout_s:g} s",
                timeout_s=self._ready_timeout_s,
            )
        try:
            answer = status.recv(65536)
        except ConnectionResetError:
            return None
        return dict(json.loads(answer)) if answer else None

    def _ensure(self) -> socket.socket:
        """The control socket of a living nursery. With the lock held."""
        if self._process is not None and self._process.poll() is not None:
            logger.error("the nursery (pid %d) died, exit code %d; starting another", self._process.pid, self._process.returncode)
            self._discard()
        if self._control is None:
            self._control = self._launch()
        return self._control

    def _launch(self) -> socket.socket:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        command = [sys.executable, "-P", "-m", "sandbox.nursery_main", str(theirs.fileno()), *self._preload]
        with theirs:
            self._process = subprocess.Popen(  # noqa: S603  (our own interpreter, our own module)
                command, pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, env=self._environment(), start_new_session=True
            )
        return ours

    def _environment(self) -> dict[str, str]:
        """Only what it needs: whatever is here, every child can read."""
        environment = {name: os.environ[name] for name in PASSED_VARIABLES if name in os.environ}
        environment |= dict.fromkeys(THREAD_VARIABLES, str(self._threads))
        environment["PYTHONPATH"] = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
        return environment

    def _discard(self) -> None:
        """Close the control socket, which ends the nursery and its children, and wait. With the lock held."""
        if self._control is not None:
            self._control.close()
            self._control = None
        if self._process is not None:
            try:
                self._process.wait(STOP_PATIENCE_S)
            except subprocess.TimeoutExpired:
                self._process.send_signal(signal.SIGKILL)  # its children die with it
                self._process.wait()
            self._process = None
