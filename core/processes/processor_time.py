"""Processor time of this process and of those it started, in seconds."""

from __future__ import annotations

import os


def processor_s() -> float:
    """Spent so far; processes that were started, as TetGen's, count when they have ended."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system
