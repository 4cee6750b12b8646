"""The version of the server that is installed."""

from __future__ import annotations

from importlib.metadata import version

SERVER_VERSION = version("integument-server")
