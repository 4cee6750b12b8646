"""Lines of logs: one per record, JSON for machines, what is known of request and job on each."""

from __future__ import annotations

import io
import json
import logging
import subprocess
import sys
import threading
from collections.abc import Iterator
from datetime import datetime

import pytest

from sandbox.log_lines import MAX_MESSAGE, JsonLines, TextLines, add_log_context, log_context


@pytest.fixture
def stream() -> Iterator[tuple[logging.Logger, io.StringIO]]:
    """A logger of its own that writes JSON."""
    out = io.StringIO()
    handler = logging.StreamHandler(out)
    handler.setFormatter(JsonLines(lambda text: text.replace("sesame", "***")))
    logger = logging.getLogger("tests.log_lines")
    logger.setLevel(logging.INFO)
    logger.propagate = False
    logger.addHandler(handler)
    yield logger, out
    logger.removeHandler(handler)


def test_a_line_says_when_what_and_of_what(stream: tuple[logging.Logger, io.StringIO]) -> None:
    logger, out = stream
    with log_context(job_id="j", attempt=2):
        add_log_context(stage="load")
        logger.info("taken: %s", "sesame\n\u2028", extra={"event": "job_claimed", "fields": {"seconds": 0.5}})
    logger.warning("later")
    first, second = map(json.loads, out.getvalue().splitlines())
    assert datetime.fromisoformat(first.pop("ts")).tzinfo is not None
    assert first == {
        "level": "info",
        "event": "job_claimed",
        "logger": "tests.log_lines",
        "message": "taken: ***\n\u2028",
        "job_id": "j",
        "attempt": 2,
        "stage": "load",
        "seconds": 0.5,
    }
    assert second["event"] == "tests.log_lines"
    assert "job_id" not in second


def test_a_traceback_and_a_flood_are_one_line_each(stream: tuple[logging.Logger, io.StringIO]) -> None:
    logger, out = stream
    try:
        raise ValueError("sesame\nand more")
    except ValueError:
        logger.exception("it broke")
    logger.info("x" * 10 * MAX_MESSAGE)
    broken, flood = map(json.loads, out.getvalue().splitlines())
    assert "Traceback" in broken["exception"]
    assert "sesame" not in broken["exception"]
    assert len(flood["message"]) == MAX_MESSAGE


def test_threads_do_not_share_what_they_know(stream: tuple[logging.Logger, io.StringIO]) -> None:
    logger, out = stream
    with log_context(job_id="mine"):
        thread = threading.Thread(target=logger.info, args=("other",))
        thread.start()
        thread.join()
        logger.info("mine")
    assert [json.loads(line).get("job_id") for line in out.getvalue().splitlines()] == [None, "mine"]


def test_people_get_text() -> None:
    record = logging.LogRecord("a.b", logging.INFO, "", 0, "hello %s", ("sesame",), None)
    with log_context(job_id="j"):
        line = TextLines(lambda text: text.replace("sesame", "***")).format(record)
    assert line.endswith("INFO a.b: hello *** [job_id=j]")


@pytest.mark.parametrize(("form", "is_json"), [("auto", True), ("json", True), ("text", False)])
def test_a_program_says_it_in_its_form_even_at_its_end(form: str, is_json: bool) -> None:
    code = (
        "import logging, warnings\n"
        "from sandbox.log_lines import configure_logging\n"
        f"configure_logging({form!r}, str)\n"
        "logging.info('up'); warnings.warn('odd'); raise RuntimeError('on purpose')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    lines = done.stderr.splitlines()
    if is_json:
        told = [json.loads(line) for line in lines]
        assert [line["level"] for line in told] == ["info", "warning", "critical"]
        assert "RuntimeError: on purpose" in told[2]["exception"]
    else:
        assert "INFO root: up" in lines[0]
        assert lines[-1] == "RuntimeError: on purpose"


def test_asking_for_the_version_of_the_tables_fills_no_log() -> None:
    code = (
        "import logging\n"
        "from sandbox.log_lines import configure_logging\n"
        "configure_logging('text', str)\n"
        "from alembic.runtime.migration import MigrationContext, log\n"
        "from sqlalchemy import create_engine\n"
        "MigrationContext.configure(create_engine('sqlite://').connect())\n"
        "log.info('Running upgrade 1 -> 2')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    (line,) = done.stderr.splitlines()
    assert line.endswith("alembic.runtime.migration: Running upgrade 1 -> 2")


def test_a_terminal_gets_no_commands_out_of_what_users_send() -> None:
    told = "skin\x1b[2J\x1b]0;owned\x07\r\u202egpj.stl\x9b"
    record = logging.LogRecord("api", logging.INFO, "", 0, "mesh %s\n\tkept", (told,), None)
    line = TextLines(lambda text: text).format(record)
    assert line.endswith("mesh skin\\x1b[2J\\x1b]0;owned\\x07\\r\\u202egpj.stl\\x9b\n\tkept")
