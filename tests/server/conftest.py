"""What operators' commands are tried with: no settings of this shell, a data folder of their own."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from server.admin.command import admin
from store.settings import PREFIX

Run = Callable[..., Any]


@pytest.fixture
def bare_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No setting but the data folder."""
    for name in [name for name in os.environ if name.startswith(PREFIX)]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("INTEGUMENT_DATA_DIR", str(tmp_path / "data"))


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """A command with --json; what it answered."""

    def run(*words: str, code: int = 0) -> Any:
        capsys.readouterr()
        assert admin(["--json", *words]) == code, capsys.readouterr().err
        return json.loads(capsys.readouterr().out)

    return run
