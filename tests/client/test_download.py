import hashlib
import random
from pathlib import Path

import pytest
from integument import Client, DownloadCorruptError, ProblemError, ServerUnreachableError

from tests.client.faulty_server import JOB_ID, Cut, Refuse, SendOn, State, faulty_server

PATH = f"/v1/jobs/{JOB_ID}/results/package"
CONTENT = random.Random(5).randbytes(300_000)


@pytest.fixture(autouse=True)
def _package(state: State) -> None:
    state.files[PATH] = CONTENT


def ranges(state: State) -> list[str | None]:
    return [seen.headers.get("range") for seen in state.requests("GET", PATH)]


def left_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_broken_download_goes_on_where_it_stopped(client: Client, state: State, tmp_path: Path) -> None:
    # more cuts than retries: bytes that arrived start the count again
    state.faults[f"GET {PATH}"].extend([Cut(20_000)] * 6)
    told: list[tuple[int, int]] = []
    path = client.download(JOB_ID, "package", tmp_path / "a.zip", on_bytes=lambda done, total: told.append((done, total)))
    assert path.read_bytes() == CONTENT
    assert ranges(state)[1:] == [f"bytes={20_000 * n}-" for n in range(1, 7)]
    assert told[-1] == (len(CONTENT), len(CONTENT))
    assert left_in(tmp_path) == ["a.zip"]


def test_a_download_is_followed_to_an_object_store_without_the_key(lab: tuple[str, State], tmp_path: Path) -> None:
    url, state = lab
    with faulty_server() as (elsewhere, store), Client(url) as client:
        store.files["/bucket/package"] = CONTENT
        state.faults[f"GET {PATH}"].append(SendOn(f"{elsewhere}/bucket/package?signature=1"))
        assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT
        (seen,) = store.seen
        assert "authorization" not in seen.headers


def test_a_later_call_resumes_what_an_earlier_one_left(client: Client, state: State, tmp_path: Path) -> None:
    state.faults[f"GET {PATH}"].extend([Cut(50_000), Cut(0), Cut(0), Cut(0), Cut(0)])
    with pytest.raises(ServerUnreachableError):
        client.download(JOB_ID, "package", tmp_path / "a.zip")
    assert left_in(tmp_path) == ["a.zip.part", "a.zip.part.etag"]
    state.seen.clear()
    state.faults.clear()
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT
    assert ranges(state) == ["bytes=50000-"]


def test_what_changed_meanwhile_is_fetched_from_the_beginning(client: Client, state: State, tmp_path: Path) -> None:
    (tmp_path / "a.zip.part").write_bytes(b"old" * 100)
    (tmp_path / "a.zip.part.etag").write_text('"' + "0" * 64 + '"', encoding="ascii")
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT
    assert ranges(state) == ["bytes=300-"]


def test_a_part_without_its_etag_is_worth_nothing(client: Client, state: State, tmp_path: Path) -> None:
    (tmp_path / "a.zip.part").write_bytes(b"whose?")
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT
    assert ranges(state) == [None]


def leave_part(folder: Path, content: bytes) -> None:
    (folder / "a.zip.part").write_bytes(content)
    (folder / "a.zip.part.etag").write_text(f'"{hashlib.sha256(CONTENT).hexdigest()}"', encoding="ascii")


def test_a_complete_part_only_needs_its_name(client: Client, tmp_path: Path) -> None:
    leave_part(tmp_path, CONTENT)
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT


def test_a_part_longer_than_the_file_is_thrown_away(client: Client, tmp_path: Path) -> None:
    leave_part(tmp_path, CONTENT + b"more")
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT


def test_a_part_spoilt_on_disk_is_fetched_again(client: Client, state: State, tmp_path: Path) -> None:
    leave_part(tmp_path, b"\0" * 1000)
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == CONTENT
    assert ranges(state) == ["bytes=1000-", None]


def test_wrong_bytes_never_get_the_name(client: Client, state: State, tmp_path: Path) -> None:
    state.stated[PATH] = "ab" * 32
    target = tmp_path / "a.zip"
    target.write_bytes(b"an older, good file")
    with pytest.raises(DownloadCorruptError) as caught:
        client.download(JOB_ID, "package", target)
    assert caught.value.got_sha256 == hashlib.sha256(CONTENT).hexdigest()
    assert target.read_bytes() == b"an older, good file"
    assert left_in(tmp_path) == ["a.zip"]


def test_into_a_folder_the_server_names_the_file_but_not_the_place(client: Client, tmp_path: Path) -> None:
    assert client.download(JOB_ID, "package", tmp_path) == tmp_path / "package.zip"


@pytest.mark.parametrize("target", ["", "a.zip"])
def test_a_missing_output_is_a_problem_and_leaves_nothing(client: Client, state: State, tmp_path: Path, target: str) -> None:
    state.faults[f"HEAD {PATH}"].append(Refuse(404, "output.not_found"))
    state.faults[f"GET {PATH}"].append(Refuse(404, "output.not_found"))
    with pytest.raises(ProblemError, match=r"output\.not_found"):
        client.download(JOB_ID, "package", tmp_path / target)
    assert left_in(tmp_path) == []


def test_an_empty_file_is_a_file(client: Client, state: State, tmp_path: Path) -> None:
    state.files[PATH] = b""
    assert client.download(JOB_ID, "package", tmp_path / "a.zip").read_bytes() == b""
