"""`integument serve` as a user starts it, for tests that need the whole of it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import psutil

from server.tether import tie_to_parent
from tests.children import children_at_work

START_S = 90.0
STOP_S = 60.0


class Embedded:
    """One run of the server in `data_dir`; `start` it again after `stop` or `kill`."""

    def __init__(self, data_dir: Path, environment: Mapping[str, str] | None = None) -> None:
        self.data_dir = data_dir
        self.output = data_dir.with_name(data_dir.name + ".output")
        self._environment = {**os.environ, **(environment or {})}
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Returns when it answers."""
        command = [sys.executable, "-m", "server", "--port", "0", "--data-dir", str(self.data_dir)]
        with self.output.open("wb") as output:
            self.process = subprocess.Popen(
                command,
                stdout=output,
                stderr=subprocess.STDOUT,
                env=self._environment,
                preexec_fn=partial(tie_to_parent, os.getpid()),
            )
        deadline = time.monotonic() + START_S
        while str(self.process.pid) != str(self._notice().get("pid")):
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(self.output.read_text())
            time.sleep(0.05)

    @property
    def url(self) -> str:
        """Where it answers."""
        return str(self._notice()["url"])

    def family(self) -> list[psutil.Process]:
        """The supervisor and everything below it."""
        assert self.process is not None
        supervisor = psutil.Process(self.process.pid)
        return [supervisor, *supervisor.children(recursive=True)]

    def child_at_work(self, job: str) -> psutil.Process:
        """What does the work of a job: neither the worker that watches it, nor a child that waits for the next job."""
        (found,) = (child for folder, child in self.children_at_work().items() if folder.startswith(f"{job}."))
        return found

    def children_at_work(self) -> dict[str, psutil.Process]:
        """Of all jobs, by the names of their folders."""
        return children_at_work(self.part("worker"))

    def part(self, name: str, *, other_than: int = 0) -> psutil.Process:
        """The process of `api`, `worker` or `valkey`; waits for it while it is being started again."""
        assert self.process is not None
        deadline = time.monotonic() + START_S
        while time.monotonic() < deadline:
            for child in psutil.Process(self.process.pid).children():
                with suppress(psutil.NoSuchProcess):  # also what is said of a zombie
                    if child.pid != other_than and name in " ".join(child.cmdline()[: 1 if name == "valkey" else 3]):
                        return child
            time.sleep(0.05)
        raise LookupError(f"no {name} below {self.process.pid}")

    def log(self, name: str) -> str:
        """What a part has said."""
        return (self.data_dir / "logs" / f"{name}.log").read_text(errors="replace")

    def stop(self, number: signal.Signals = signal.SIGTERM) -> int:
        """Ask it to end; its exit code."""
        assert self.process is not None
        self.process.send_signal(number)
        return self._wait()

    def kill(self) -> None:
        """SIGKILL to the supervisor alone; returns when nothing of it lives any more."""
        family = self.family()
        assert self.process is not None
        self.process.kill()
        self._wait()
        _, alive = psutil.wait_procs(family, timeout=10)
        assert alive == []

    def _wait(self) -> int:
        assert self.process is not None
        code = self.process.wait(STOP_S)
        self.process = None
        return code

    def _notice(self) -> dict[str, object]:
        try:
            found: dict[str, object] = json.loads((self.data_dir / "server.json").read_text())
        except FileNotFoundError:
            return {}
        return found


@contextmanager
def embedded(data_dir: Path, environment: Mapping[str, str] | None = None) -> Iterator[Embedded]:
    """Start it, and make sure that it is gone at the end."""
    server = Embedded(data_dir, environment)
    try:
        server.start()
        yield server
    finally:
        if server.process is not None:
            server.stop()
