"""One program of the lab: the API, or the worker of a host. It can be killed, paused, stopped and started again."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from server.tether import tie_to_parent

START_S = 90.0
STOP_S = 60.0


class Member:
    """`command` and `check` are those of docker-compose.yml; output goes to `folder/<host>.log`."""

    def __init__(
        self, folder: Path, host: str, command: Sequence[str], check: Sequence[str], environment: Mapping[str, str]
    ) -> None:
        self.host = host
        self.log = folder / f"{host}.log"
        self.environment = dict(environment)
        self._folder = folder
        self._command = command
        self._check = check
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def process(self) -> subprocess.Popen[bytes]:
        """The latest one, dead or alive."""
        assert self._process is not None, f"{self.host} was never started"
        return self._process

    @property
    def is_running(self) -> bool:
        """A paused one counts."""
        return self._process is not None and self._process.poll() is None

    def start(self) -> None:
        """Returns at once. It dies with the thread that called this."""
        self._process = self.run(self._command, self.log)

    def run(self, command: Sequence[str], log: Path) -> subprocess.Popen[bytes]:
        """Another program with the same environment."""
        python, *arguments = command
        assert python == "python"
        with log.open("ab") as output:
            return subprocess.Popen(
                [sys.executable, *arguments],
                env={**os.environ, **self.environment},
                stdout=output,
                stderr=output,
                cwd=self._folder,
                preexec_fn=partial(tie_to_parent, os.getpid()),
            )

    def is_healthy(self) -> bool:
        """What the container's health check would say."""
        return self.run(self._check, self._health_log).wait(START_S) == 0

    def await_health(self) -> None:
        """Fails with its log if it ends, or takes too long."""
        deadline = time.monotonic() + START_S
        while not self.is_healthy():
            assert self.is_running, self.log.read_text()
            assert time.monotonic() < deadline, self._health_log.read_text()

    @property
    def _health_log(self) -> Path:
        return self._folder / f"{self.host}-health.log"

    def signal(self, number: signal.Signals) -> None:
        """SIGSTOP it, SIGCONT it, SIGTERM it; nothing happens to one that has ended."""
        self.process.send_signal(number)

    def kill(self) -> None:
        """As a power cut would."""
        self.process.kill()
        self.process.wait(STOP_S)

    def stop(self) -> None:
        """In good order; one that was killed is left alone."""
        if self.process.poll() == -signal.SIGKILL:  # a test's doing
            return
        self.process.send_signal(signal.SIGTERM)
        assert self.process.wait(STOP_S) == 0, self.log.read_text()
