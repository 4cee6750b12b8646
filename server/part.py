"""One program the supervisor runs: API, worker or Valkey."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

from server.backoff import Backoff, RestartPolicy
from server.log_file import LogFile
from server.tether import tie_to_parent

READ_BYTES = 65_536


@dataclass(frozen=True, slots=True)
class Program:
    """What to run. `grace_s` is the time between SIGTERM and SIGKILL when it is stopped."""

    name: str
    command: tuple[str, ...]
    environment: Mapping[str, str]
    grace_s: float
    cwd: str


@dataclass(slots=True)
class Part:
    """A program, its running process (None while it is down) and its log.

    The process gets a session of its own (a Ctrl-C reaches the supervisor alone, which stops the parts in order), dies
    with the supervisor, and inherits the lock of the data folder.
    """

    program: Program
    log: LogFile
    lock_fd: int
    backoff: Backoff = field(default_factory=lambda: Backoff(RestartPolicy()))
    process: subprocess.Popen[bytes] | None = None
    pid_fd: int = -1
    restart_at_s: float | None = None
    """On the monotonic clock; None unless the part is down and waits for its next start."""

    @property
    def name(self) -> str:
        """For people and file names."""
        return self.program.name

    @property
    def output_fd(self) -> int:
        """Its stdout and stderr; only while it runs."""
        if self.process is None or self.process.stdout is None:
            raise ValueError(f"{self.name} does not run")
        return self.process.stdout.fileno()

    def start(self) -> None:
        """Raises: OSError when the program cannot be executed."""
        self.process = subprocess.Popen(
            self.program.command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=dict(self.program.environment),
            cwd=self.program.cwd,
            pass_fds=(self.lock_fd,),
            start_new_session=True,
            preexec_fn=partial(tie_to_parent, os.getpid()),
        )
        os.set_blocking(self.output_fd, False)
        self.pid_fd = os.pidfd_open(self.process.pid)
        self.restart_at_s = None

    def copy_output(self) -> bool:
        """Move what it said to the log; False at the end of its output."""
        while True:
            try:
                chunk = os.read(self.output_fd, READ_BYTES)
            except BlockingIOError:
                return True
            if not chunk:
                return False
            self.log.write(chunk)

    def collect(self) -> int:
        """After its end: the last output and the exit code; negative: the signal that killed it."""
        if self.process is None:
            raise ValueError(f"{self.name} does not run")
        self.copy_output()
        code = self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()
        os.close(self.pid_fd)
        self.process, self.pid_fd = None, -1
        return code

    def signal(self, number: signal.Signals) -> None:
        """Does nothing once it is down."""
        if self.process is not None:
            self.process.send_signal(number)


def describe_exit(code: int) -> str:
    """`exit code 3` or `signal SIGSEGV`."""
    return f"exit code {code}" if code >= 0 else f"signal {signal.Signals(-code).name}"
