"""A file of 1 GiB by tus-js-client, with the API killed on the way: constant memory, whole bytes."""

from __future__ import annotations

import hashlib
import signal
import time
from pathlib import Path

import httpx
import psutil
import pytest

from benchmarks.load.memory import Memory
from benchmarks.load.uploading import write_stl
from tests.embedded import Embedded, embedded
from tests.tus_js import start_tus_js, told_by

MIB = 1024**2
GROWTH_MIB = 64
CHUNKS = 64  # so many round trips that the kill finds it under way


@pytest.mark.parametrize("size_mib", [16, pytest.param(1024, marks=pytest.mark.slow)])
def test_a_file_survives_the_kill_of_the_api_while_a_browser_client_sends_it(tmp_path: Path, size_mib: int) -> None:
    file = tmp_path / "large.stl"
    write_stl(file, size_mib * MIB)
    with embedded(tmp_path / "data", {"INTEGUMENT_UPLOAD_LIMIT_BYTES": "4GiB"}) as server:
        chunk = size_mib * MIB // CHUNKS
        sending = start_tus_js(f"{server.url}/v1/uploads", file, tmp_path / "memory", chunk=chunk)
        killed = _kill_when_under_way(server, chunk)
        again = server.part("api", other_than=killed)
        _await_answer(server.url)
        with Memory(again) as memory:
            told = told_by(sending)
        assert told["error"] is None
        assert told["sent"] == file.stat().st_size
        assert told["retries"] > 0, "it noticed the kill and came back by itself"
        assert memory.growth_mib <= GROWTH_MIB, memory.series
        with file.open("rb") as sent, (server.data_dir / "uploads" / told["url"].rpartition("/")[2]).open("rb") as kept:
            assert hashlib.file_digest(sent, "sha256").digest() == hashlib.file_digest(kept, "sha256").digest()


def _kill_when_under_way(server: Embedded, sent: int) -> int:
    """SIGKILL to the API once some of the file is here; its number."""
    folder, deadline = server.data_dir / "uploads", time.monotonic() + 60
    while not any(path.stat().st_size > sent for path in folder.glob("*")):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    api: psutil.Process = server.part("api")
    api.send_signal(signal.SIGKILL)
    return api.pid


def _await_answer(url: str) -> None:
    deadline = time.monotonic() + 90
    while True:
        try:
            if httpx.get(f"{url}/healthz", timeout=5, trust_env=False).status_code == 200:
                return
        except httpx.TransportError:
            assert time.monotonic() < deadline
        time.sleep(0.05)
