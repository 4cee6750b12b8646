"""Parts are kept alive, given up by name, stopped in order, and never outlive the supervisor. Real processes throughout."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import psutil
import pytest

from core.errors import InternalError
from server.backoff import Backoff, RestartPolicy
from server.log_file import LogFile
from server.part import Part, Program
from server.stop_signals import StopSignals
from server.supervisor import Supervisor

SLEEP = "import time; print('up', flush=True); time.sleep(600)"
STUBBORN = f"import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); {SLEEP}"
POLICY = RestartPolicy(first_s=0.2, longest_s=0.2, crashes=4, window_s=60.0)


@dataclass
class Stage:
    """A supervisor with what it said and whom it missed."""

    folder: Path
    supervisor: Supervisor
    said: list[str]
    crashed: list[str]
    parts: dict[str, Part] = field(default_factory=dict)

    def start(self, name: str, script: str, *, grace_s: float = 5.0, log_bytes: int = 1_000_000) -> Part:
        """A Python program as a part."""
        program = Program(name, (sys.executable, "-c", script), dict(os.environ), grace_s, str(self.folder))
        part = Part(program, LogFile(self.folder / f"{name}.log", log_bytes), self.lock_fd, Backoff(POLICY))
        self.parts[name] = part
        self.supervisor.start(part)
        return part

    def until_up(self, *parts: Part) -> None:
        """Serve until these have said something."""
        deadline = time.monotonic() + 10
        while not all(part.log.path.stat().st_size for part in parts):
            assert time.monotonic() < deadline
            self.supervisor.run(0.02)

    @property
    def lock_fd(self) -> int:
        """Any descriptor will do."""
        return 2


@pytest.fixture
def stage(tmp_path: Path) -> Iterator[Stage]:
    said: list[str] = []
    crashed: list[str] = []
    with StopSignals() as signals:
        stage = Stage(tmp_path, Supervisor(signals, said.append, lambda part: crashed.append(part.name)), said, crashed)
        yield stage
        stage.supervisor.stop()


def test_crashed_part_is_started_again(stage: Stage) -> None:
    part = stage.start("api", SLEEP)
    stage.until_up(part)
    assert part.process is not None
    first = part.process.pid
    part.process.kill()
    started = time.monotonic()
    while part.process is None or part.process.pid == first:
        assert time.monotonic() < started + 10
        stage.supervisor.run(0.02)
    assert stage.said == ["The api ended with signal SIGKILL; starting it again in 0.2 s."]
    assert stage.crashed == ["api"]


def test_part_that_keeps_crashing_is_given_up_by_name_with_the_end_of_its_log(stage: Stage) -> None:
    stage.start("worker", "import sys; print('no broker at 10.0.0.1', file=sys.stderr); sys.exit(3)")
    with pytest.raises(InternalError) as failure:
        stage.supervisor.run(20.0)
    assert failure.value.code == "server.part_crashed"
    assert failure.value.facts == {"part": "worker", "crashes": 4}
    assert "worker" in failure.value.message
    assert "exit code 3" in failure.value.message
    assert failure.value.message.endswith("no broker at 10.0.0.1")
    assert stage.crashed == ["worker"] * 3
    assert (stage.folder / "worker.log").read_text() == "no broker at 10.0.0.1\n" * 4


def test_end_without_an_error_is_a_crash_too(stage: Stage) -> None:
    stage.start("api", "pass")
    with pytest.raises(InternalError, match="exit code 0"):
        stage.supervisor.run(20.0)


def test_program_that_cannot_be_started_is_named(stage: Stage) -> None:
    program = Program("valkey", ("/no/such/program",), {}, 1.0, str(stage.folder))
    with pytest.raises(InternalError) as failure:
        stage.supervisor.start(Part(program, LogFile(stage.folder / "valkey.log"), stage.lock_fd))
    assert failure.value.code == "server.part_not_started"
    assert "/no/such/program" in failure.value.message


def test_parts_stop_one_after_the_other_last_started_first(stage: Stage) -> None:
    note = stage.folder / "order"
    script = (
        "import signal, sys, time\n"
        "def stop(*_):\n time.sleep(0.2); open({note!r}, 'a').write({name!r} + '\\n'); sys.exit(0)\n"
        "signal.signal(signal.SIGTERM, stop); print('up', flush=True); time.sleep(600)"
    )
    names = ("valkey", "worker", "api")
    stage.until_up(*(stage.start(name, script.format(note=str(note), name=name)) for name in names))
    stage.supervisor.stop()
    assert note.read_text().split() == ["api", "worker", "valkey"]
    assert stage.said == []
    assert stage.crashed == []


def test_part_that_ignores_sigterm_is_killed_after_its_grace(stage: Stage) -> None:
    part = stage.start("worker", STUBBORN, grace_s=0.5)
    stage.until_up(part)
    started = time.monotonic()
    stage.supervisor.stop()
    assert 0.5 <= time.monotonic() - started < 3.0
    assert stage.said == ["The worker did not stop in time and is killed."]
    assert part.process is None


def test_second_signal_ends_the_patience(stage: Stage) -> None:
    part = stage.start("worker", STUBBORN, grace_s=60.0)
    stage.until_up(part)
    os.kill(os.getpid(), signal.SIGINT)
    assert stage.supervisor.run(10.0)
    impatience = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGTERM))
    impatience.start()
    started = time.monotonic()
    stage.supervisor.stop()
    impatience.join()
    assert 0.2 < time.monotonic() - started < 5.0


def test_signal_ends_the_wait_at_once(stage: Stage) -> None:
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGTERM)).start()
    started = time.monotonic()
    assert stage.supervisor.run()
    assert time.monotonic() - started < 2.0


def test_ctrl_c_of_the_terminal_does_not_reach_the_parts(stage: Stage) -> None:
    part = stage.start("api", SLEEP)
    assert part.process is not None
    assert os.getpgid(part.process.pid) != os.getpgrp()
    assert os.getsid(part.process.pid) == part.process.pid


def test_flood_of_output_is_written_down_and_bounded(stage: Stage) -> None:
    script = "import sys\nfor n in range(200_000): print(n, 'x' * 20)\nsys.stdout.flush(); import time; time.sleep(600)"
    part = stage.start("worker", script, log_bytes=100_000)
    deadline = time.monotonic() + 20
    while "199999" not in part.log.tail(1):
        assert time.monotonic() < deadline
        stage.supervisor.run(0.02)
    assert sum(file.stat().st_size for file in stage.folder.glob("worker.log*")) < 400_000


def test_what_a_part_leaves_behind_is_ended_too(stage: Stage) -> None:
    detached = (
        "import subprocess, sys, time\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'], start_new_session=True,"
        " stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)\n"
        "print(child.pid, flush=True); time.sleep(600)"
    )
    part = stage.start("worker", detached)
    stage.until_up(part)
    orphan = psutil.Process(int(part.log.tail(1)))
    stage.supervisor.stop()
    assert not orphan.is_running()


SUPERVISOR = """
import os, sys
from pathlib import Path
from server.log_file import LogFile
from server.part import Part, Program
from server.stop_signals import StopSignals
from server.supervisor import Supervisor
folder = Path(sys.argv[1])
with StopSignals() as signals:
    supervisor = Supervisor(signals, print, lambda part: None)
    for name in ("valkey", "api"):
        program = Program(name, (sys.executable, "-c", sys.argv[2]), dict(os.environ), 1.0, str(folder))
        part = Part(program, LogFile(folder / name), 2)
        supervisor.start(part)
        print(part.process.pid, flush=True)
    supervisor.run()
    supervisor.stop()
"""


def test_parts_die_with_a_killed_supervisor(tmp_path: Path) -> None:
    command = [sys.executable, "-c", SUPERVISOR, str(tmp_path), STUBBORN]
    supervisor = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert supervisor.stdout is not None
    parts = [psutil.Process(int(supervisor.stdout.readline())) for _ in range(2)]
    supervisor.kill()
    supervisor.communicate()
    _, alive = psutil.wait_procs(parts, timeout=5)
    assert alive == []
