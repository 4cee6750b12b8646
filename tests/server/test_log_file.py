"""Logs of bounded size."""

from pathlib import Path

from server.log_file import LogFile


def test_log_never_takes_more_than_two_files_of_the_limit(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "part.log", limit_bytes=1000)
    for number in range(500):
        log.write(b"line %03d\n" % number)
    log.close()
    assert sorted(file.name for file in tmp_path.iterdir()) == ["part.log", "part.log.1"]
    assert all(file.stat().st_size <= 1000 for file in tmp_path.iterdir())
    kept = (log.older.read_bytes() + log.path.read_bytes()).splitlines()
    assert kept == [b"line %03d" % number for number in range(500 - len(kept), 500)]  # the newest lines, no gap


def test_tail_gives_the_last_lines(tmp_path: Path) -> None:
    log = LogFile(tmp_path / "part.log")
    log.write(b"".join(b"line %d\n" % number for number in range(5000)) + b"\xff broken text")
    assert log.tail(3) == "line 4998\nline 4999\n\ufffd broken text"
    assert len(log.tail(10_000)) < 9000
    log.close()


def test_log_of_an_earlier_run_is_continued(tmp_path: Path) -> None:
    for word in (b"first\n", b"second\n"):
        log = LogFile(tmp_path / "part.log")
        log.write(word)
        log.close()
    assert (tmp_path / "part.log").read_bytes() == b"first\nsecond\n"
