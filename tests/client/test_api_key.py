"""The key goes with every request of this user, in one header, and nowhere else."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from integument import ArgumentError, Client
from integument.cli import main

from tests.client.faulty_server import State

KEY = "itg_abcdefghijkl_" + "s" * 43 + "_123456"


@pytest.fixture(autouse=True)
def _no_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("INTEGUMENT_API_KEY", raising=False)


def sent(state: State) -> set[str | None]:
    assert state.seen
    assert all(KEY not in seen.path for seen in state.seen)
    return {seen.headers.get("authorization") for seen in state.seen}


def test_without_a_key_nothing_is_sent(lab: tuple[str, State]) -> None:
    with Client(lab[0]) as client:
        list(client.jobs())
    assert sent(lab[1]) == {None}


def test_the_client_takes_it_by_name_or_from_the_environment(lab: tuple[str, State], monkeypatch: pytest.MonkeyPatch) -> None:
    with Client(lab[0], api_key=KEY) as client:
        list(client.jobs())
    assert sent(lab[1]) == {f"Bearer {KEY}"}
    monkeypatch.setenv("INTEGUMENT_API_KEY", "itg_other\n")
    with Client(lab[0], api_key=KEY) as client:
        list(client.jobs())
    assert sent(lab[1]) == {f"Bearer {KEY}"}
    lab[1].seen.clear()
    with Client(lab[0]) as client:
        list(client.jobs())
    assert sent(lab[1]) == {"Bearer itg_other"}


def test_the_command_line_takes_it_from_a_file(lab: tuple[str, State], tmp_path: Path) -> None:
    path = tmp_path / "key"
    path.write_text(f"{KEY}\n")
    assert main(["jobs", "--server", lab[0], "--key-file", str(path)]) == 0
    assert sent(lab[1]) == {f"Bearer {KEY}"}


@pytest.mark.parametrize("content", [None, b"", b" \n", b"two words", b"a\nb", "schlüssel".encode(), b"x" * 500])
def test_a_file_that_is_no_key_is_refused_before_anything_is_sent(
    lab: tuple[str, State], tmp_path: Path, content: bytes | None, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "key"
    if content is not None:
        path.write_bytes(content)
    assert main(["jobs", "--server", lab[0], "--key-file", str(path), "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["type"] == "ArgumentError"
    assert lab[1].seen == []


def test_a_wrong_key_is_not_repeated_in_the_message() -> None:
    with pytest.raises(ArgumentError) as caught:
        Client("http://127.0.0.1:1", api_key="secret words")
    assert "secret" not in str(caught.value)
