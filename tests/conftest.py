"""Fixtures every test may ask for; nothing is started before one does."""

import signal

pytest_plugins = ("tests.postgres", "tests.seaweed", "tests.valkey")

# a shell without job control starts what it runs in the background deaf to Ctrl-C, and programs hand that down;
# the tests that interrupt programs mean those a person started
signal.signal(signal.SIGINT, signal.default_int_handler)
