"""The command line `integument`."""

from integument.cli.main import main

__all__ = ["main"]
