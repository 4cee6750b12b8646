"""Archives for cohorts in pieces against the real server: broken off, stopped, asked again; nothing comes twice."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import trimesh
from integument import Client, EmbeddedServer
from integument import begun_upload as module
from integument.errors import ProblemError, ServerUnreachableError
from integument.transport import Transport

PIECE = 4000
Watch = Callable[[str, int], None]  # method of a request that was answered, and how many such there were


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with EmbeddedServer(tmp_path_factory.mktemp("data")) as running:
        yield running.url


@pytest.fixture
def client(server: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Client]:
    monkeypatch.setenv("INTEGUMENT_DATA_DIR", str(tmp_path / "own"))
    monkeypatch.setattr(module, "PIECE_BYTES", PIECE)
    with Client(server, first_pause_s=0.01) as client:
        yield client


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """Two subjects, stored as they are: five pieces and more."""
    path = tmp_path / "study.zip"
    ball = io.BytesIO()
    trimesh.creation.icosphere(2, 60.0).export(ball, file_type="stl")
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("anna", "bert"):
            archive.writestr(f"{name}.stl", ball.getvalue())
    assert path.stat().st_size > 5 * PIECE
    return path


class Wire:
    """What went over it, and `stop` called after every answer."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, stop: Watch = lambda method, count: None) -> None:
        self.seen: list[tuple[str, str]] = []
        self.sent = 0
        attempt = Transport.attempt

        def watched(transport: Transport, method: str, path: str, *arguments: Any, **more: Any) -> httpx.Response:
            reply = attempt(transport, method, path, *arguments, **more)
            self.seen.append((method, path))
            self.sent += len(more.get("content") or b"") if method == "PATCH" else 0
            stop(method, sum(one == method for one, _ in self.seen))
            return reply

        monkeypatch.setattr(Transport, "attempt", watched)

    def count(self, method: str) -> int:
        return sum(one == method for one, _ in self.seen)


def test_what_breaks_goes_on_and_no_byte_is_sent_twice(client: Client, study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def lose_an_answer(method: str, count: int) -> None:
        if (method, count) == ("PATCH", 2):
            raise ServerUnreachableError("here", "the answer was lost", untouched=False)

    wire, heard = Wire(monkeypatch, lose_an_answer), []
    cohort = client.create_cohort_of_archive("validate", study, on_bytes=lambda done, total: heard.append((done, total)))
    assert (cohort.subjects, cohort.counts.refused) == (2, 0)
    assert wire.sent == study.stat().st_size
    assert heard[-1] == (study.stat().st_size, study.stat().st_size)
    assert not list((study.parent / "own" / "begun-uploads").iterdir())


def test_a_call_that_was_stopped_is_gone_on_with_by_the_next(
    client: Client, study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(method: str, count: int) -> None:
        if (method, count) == ("PATCH", 3):
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        first = Wire(patch, stop)
        with pytest.raises(KeyboardInterrupt):
            client.create_cohort_of_archive("validate", study)
    assert first.sent == 3 * PIECE
    wire = Wire(monkeypatch)
    assert client.create_cohort_of_archive("validate", study).subjects == 2
    assert first.sent + wire.sent == study.stat().st_size
    assert ("POST", "/v1/uploads") not in wire.seen


def test_a_cohort_whose_answer_was_lost_is_not_made_twice(client: Client, study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(method: str, count: int) -> None:
        if (method, count) == ("POST", 2):
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        Wire(patch, stop)
        with pytest.raises(KeyboardInterrupt):
            client.create_cohort_of_archive("validate", study, name="once")
    wire = Wire(monkeypatch)
    again = client.create_cohort_of_archive("validate", study, name="once")
    assert [one.id for one in client.cohorts() if one.name == "once"] == [again.id]
    assert wire.sent == 0


def test_refused_for_its_settings_the_bytes_are_not_sent_again(
    client: Client, study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ProblemError, match="process"):
        client.create_cohort_of_archive("shrink", study)
    wire = Wire(monkeypatch)
    assert client.create_cohort_of_archive("validate", study).subjects == 2
    assert wire.sent == 0
    # another file at the same place is another upload
    with zipfile.ZipFile(study, "a") as archive:
        archive.writestr("notes.txt", "seen")
    assert client.create_cohort_of_archive("validate", study).subjects == 2
    assert wire.sent == study.stat().st_size


def test_bytes_and_an_upload_the_server_forgot(client: Client, study: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert client.create_cohort_of_archive("validate", study.read_bytes()).subjects == 2
    module.Memory.of(study, "mm").keep(module.BegunUpload("/v1/uploads/00000000-0000-4000-8000-000000000000", "long-ago"))
    wire = Wire(monkeypatch)
    assert client.create_cohort_of_archive("validate", study).subjects == 2
    assert wire.sent == study.stat().st_size
