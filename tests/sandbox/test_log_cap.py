"""A child that prints without end."""

from __future__ import annotations

import os
from pathlib import Path

from sandbox.confinement import LOG_NAME
from sandbox.log_cap import cap_log


def test_a_long_log_starts_over_and_the_writer_goes_on(tmp_path: Path) -> None:
    log = tmp_path / LOG_NAME
    writer = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    os.write(writer, b"x" * 100)
    assert not cap_log(tmp_path, 100)
    os.write(writer, b"y")
    assert cap_log(tmp_path, 100)
    os.write(writer, b"last words")
    os.close(writer)
    assert log.read_bytes() == b"last words"


def test_nothing_but_the_log_is_ever_cut(tmp_path: Path) -> None:
    assert not cap_log(tmp_path, 1)
    precious, log = tmp_path / "precious", tmp_path / LOG_NAME
    precious.write_bytes(b"z" * 100)
    log.symlink_to(precious)
    assert not cap_log(tmp_path, 1)
    log.unlink()
    log.hardlink_to(precious)
    assert not cap_log(tmp_path, 1)
    log.unlink()
    os.mkfifo(log)
    assert not cap_log(tmp_path, 1)
    log.unlink()
    log.mkdir()
    assert not cap_log(tmp_path, 1)
    assert precious.read_bytes() == b"z" * 100
