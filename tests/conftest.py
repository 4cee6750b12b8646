"""Fixtures every test may ask for; nothing is started before one does."""

import logging
import signal
from collections.abc import Iterator

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
