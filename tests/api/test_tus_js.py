"""Uploads by tus-js-client, the client of browsers and of Uppy, in Node.js."""

from __future__ import annotations

import hashlib
import subprocess
from pathlib import Path

import pytest

from api.partial_file import partial_file
from tests.api.live import Live
from tests.tus_js import run_tus_js, start_tus_js, told_by


@pytest.fixture
def file(tmp_path: Path, stl: bytes) -> Path:
    path = tmp_path / "skin.stl"
    path.write_bytes(stl)
    return path


def test_it_sends_a_file_in_pieces_with_its_names(api: Live, file: Path, stl: bytes, tmp_path: Path) -> None:
    names = {"filename": "skïn.stl", "unit": "cm", "name": "a skin"}
    told = run_tus_js(f"{api.url}/v1/uploads", file, tmp_path / "memory", chunk=50, metadata=names)
    assert (told["error"], told["sent"], told["retries"]) == (None, len(stl), 0)
    mesh = api.client.post(f"{told['url']}/mesh").json()
    assert (mesh["file_name"], mesh["unit"], mesh["name"]) == ("skïn.stl", "cm", "a skin")
    assert mesh["sha256"] == hashlib.sha256(stl).hexdigest()


def test_it_goes_on_after_it_was_ended(api: Live, file: Path, stl: bytes, tmp_path: Path) -> None:
    endpoint, memory = f"{api.url}/v1/uploads", tmp_path / "memory"
    first = run_tus_js(endpoint, file, memory, chunk=50, abortAt=100)
    assert first["sent"] == 100
    second = run_tus_js(endpoint, file, memory, chunk=50)
    assert (second["url"], second["resumedFrom"], second["error"]) == (first["url"], 100, None)
    assert api.client.post(f"{second['url']}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_it_waits_while_another_request_writes(api: Live, file: Path, stl: bytes, tmp_path: Path) -> None:
    endpoint, memory = f"{api.url}/v1/uploads", tmp_path / "memory"
    first = run_tus_js(endpoint, file, memory, chunk=50, abortAt=50)
    with partial_file(api.services.uploads_dir, first["url"].rpartition("/")[2]):
        running = start_tus_js(endpoint, file, memory, chunk=50)
        with pytest.raises(subprocess.TimeoutExpired):
            running.wait(2)
    told = told_by(running)
    assert told["error"] is None
    assert told["retries"] > 0
    assert told["sent"] == len(stl)


def test_what_it_terminates_is_gone(api: Live, file: Path, tmp_path: Path) -> None:
    told = run_tus_js(f"{api.url}/v1/uploads", file, tmp_path / "memory", chunk=50, abortAt=50, terminate=True)
    assert api.client.get(told["url"]).status_code == 404


def test_it_is_told_of_a_file_that_is_too_large(api: Live, tmp_path: Path) -> None:
    large = tmp_path / "large.stl"
    large.write_bytes(bytes(64 * 1024 + 1))
    told = run_tus_js(f"{api.url}/v1/uploads", large, tmp_path / "memory", chunk=50_000, retryDelays=[200])
    assert "413" in told["error"]
    assert told["url"] is None
