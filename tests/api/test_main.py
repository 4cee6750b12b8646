"""`python -m api` as a process."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from api.__main__ import main
from store.database import Database
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def started(settings: Settings) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The process, once it answers."""
    process = subprocess.Popen(
        [sys.executable, "-m", "api"],
        env={**os.environ, **settings.as_environment()},
        stderr=subprocess.PIPE,
        text=True,
        cwd=settings.data_dir,
    )
    url = f"http://127.0.0.1:{settings.port}"
    try:
        deadline = time.monotonic() + 60
        while True:
            try:
                assert httpx.get(f"{url}/healthz", trust_env=False).status_code == 200
                break
            except httpx.ConnectError:
                assert process.poll() is None, process.communicate()[1]
                assert time.monotonic() < deadline
                time.sleep(0.05)
        yield process, url
    finally:
        process.kill()
        process.communicate()


def test_a_signal_ends_it_at_once_though_a_client_listens(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, port=free_port())
    with started(settings) as (process, url):
        database = Database(settings)
        job = Jobs(database).create(DEFAULT_WORKSPACE, "validate", {})
        database.close()
        with httpx.stream("GET", f"{url}/v1/jobs/{job.id}/events", timeout=20, trust_env=False) as stream:
            lines = stream.iter_lines()
            next(lines)
            asked = time.monotonic()
            process.send_signal(signal.SIGTERM)
            assert [line for line in lines if line.startswith("event: done")] == []
        assert process.wait(20) == 0
        assert time.monotonic() - asked < 10


def test_nothing_of_it_is_left_after_kill_9(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, port=free_port())
    with started(settings) as (process, url):
        children = [int(pid) for pid in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
        assert len(children) == 1, "the nursery"
        taken = subprocess.run(
            [sys.executable, "-m", "api"],
            env={**os.environ, **settings.as_environment()},
            capture_output=True,
            text=True,
            timeout=60,
            cwd=tmp_path,
        )
        assert taken.returncode == 3
        assert "address already in use" in taken.stderr
        process.kill()
        process.wait(10)
        deadline = time.monotonic() + 20
        while any(is_alive(pid) for pid in children) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not any(is_alive(pid) for pid in children)
        with pytest.raises(httpx.ConnectError):
            httpx.get(f"{url}/healthz", trust_env=False)


def is_alive(pid: int) -> bool:
    try:
        return ") Z " not in Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return False


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"INTEGUMENT_HOST": "0.0.0.0"}, "admin keys create"),
        ({"INTEGUMENT_HOST": "::"}, "admin keys create"),
        ({"INTEGUMENT_HOST": "no.such.host.invalid"}, "has no address"),
        ({"INTEGUMENT_PORT": "99999"}, "port"),
        ({"INTEGUMENT_PROT": "8000"}, "INTEGUMENT_PORT"),
    ],
)
def test_wrong_settings_end_it_with_a_word(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    changed: dict[str, str],
    said: str,
) -> None:
    for name, value in {"INTEGUMENT_DATA_DIR": str(tmp_path / "data"), **changed}.items():
        monkeypatch.setenv(name, value)
    assert main() == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "data").exists()
