"""The last words of a child are read from its own log, never from where it points."""

import os
from pathlib import Path

import pytest

from sandbox.confinement import LOG_NAME
from sandbox.outcome import LOG_TAIL_BYTES, log_tail


def test_only_the_end_is_read(tmp_path: Path) -> None:
    assert log_tail(tmp_path) == b""
    (tmp_path / LOG_NAME).write_bytes(b"x" * 10 + b"y" * LOG_TAIL_BYTES)
    assert log_tail(tmp_path) == b"y" * LOG_TAIL_BYTES


@pytest.mark.parametrize("kind", ["link", "pipe", "folder"])
def test_what_is_no_plain_file_is_not_read(tmp_path: Path, kind: str) -> None:
    (tmp_path / "secret").write_text("token")
    log = tmp_path / LOG_NAME
    {"link": lambda: log.symlink_to(tmp_path / "secret"), "pipe": lambda: os.mkfifo(log), "folder": log.mkdir}[kind]()
    assert log_tail(tmp_path) == b""
