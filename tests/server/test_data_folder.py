"""One server per data folder."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from core.errors import InputError, StateError
from server.data_folder import DataFolder

HOLDER = """
import sys, subprocess
from pathlib import Path
from server.data_folder import DataFolder
folder = DataFolder(Path(sys.argv[1]))
heir = subprocess.Popen(["sleep", sys.argv[2]], pass_fds=(folder.lock_fd,)) if len(sys.argv) > 2 else None
folder.publish("http://127.0.0.1:1234")
print("held", flush=True)
sys.stdin.read()
"""


def hold(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    """Another process that holds the folder until it is killed."""
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(folder), *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    return holder


def end(holder: subprocess.Popen[str]) -> None:
    holder.kill()
    holder.communicate()


def test_folder_is_private_and_its_notice_is_complete(tmp_path: Path) -> None:
    loose = tmp_path / "data"
    loose.mkdir(mode=0o755)
    folder = DataFolder(loose)
    assert loose.stat().st_mode & 0o777 == 0o700
    folder.publish("http://127.0.0.1:8000")
    notice = json.loads(folder.notice.read_text())
    assert (notice["url"], notice["pid"]) == ("http://127.0.0.1:8000", os.getpid())
    assert notice["started_at"].endswith("+00:00")
    folder.release()
    assert not folder.notice.exists()


def test_second_server_is_refused_with_the_address_of_the_first(tmp_path: Path) -> None:
    holder = hold(tmp_path)
    started = time.monotonic()
    with pytest.raises(StateError) as refusal:
        DataFolder(tmp_path)
    assert time.monotonic() - started < 3.0
    assert refusal.value.code == "server.already_running"
    assert "http://127.0.0.1:1234" in refusal.value.message
    assert refusal.value.facts["pid"] == holder.pid
    assert json.loads((tmp_path / "server.json").read_text())["url"] == "http://127.0.0.1:1234"  # and left in peace
    end(holder)


def test_folder_of_a_killed_server_is_taken_over(tmp_path: Path) -> None:
    end(hold(tmp_path))
    assert (tmp_path / "server.json").exists()
    folder = DataFolder(tmp_path)
    assert not folder.notice.exists()  # it would send clients to a dead address
    folder.release()


def test_takeover_waits_for_the_parts_of_a_killed_server(tmp_path: Path) -> None:
    holder = hold(tmp_path, "1")
    holder.send_signal(signal.SIGKILL)
    started = time.monotonic()
    DataFolder(tmp_path).release()
    assert 0.6 < time.monotonic() - started < 4.0
    end(holder)


@pytest.mark.parametrize("name", ["file/data", "what?/data"])
def test_folder_that_cannot_be_used_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError) as refusal:
        DataFolder(tmp_path / name)
    assert refusal.value.code == "server.folder_unusable"
