"""Fixtures every test may ask for; nothing is started before one does."""

import logging
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.log_lines import log_context

pytest_plugins = ("tests.postgres", "tests.seaweed", "tests.valkey")

# a shell without job control starts what it runs in the background deaf to Ctrl-C, and programs hand that down;
# the tests that interrupt programs mean those a person started
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def _logging_is_left_as_it_was() -> Iterator[None]:
    """Programs under test set it up for their process, which is ours; a handler left behind writes where nobody reads."""
    handlers, level = logging.root.handlers[:], logging.root.level
    with log_context():
        yield
    logging.root.handlers[:] = handlers
    logging.root.setLevel(level)


@pytest.fixture(autouse=True)
def _broken_pipes_stay_errors() -> Iterator[None]:
    """Libraries may give SIGPIPE its default back: then another test that writes to a killed server ends without a word."""
    yield
    ignored = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("SigIgn"))
    assert int(ignored.split()[1], 16) >> (signal.SIGPIPE - 1) & 1, "SIGPIPE is not ignored any more"
