"""What admin commands share of argparse."""

from __future__ import annotations

import argparse
from datetime import timedelta
from typing import TypeAlias

Subparsers: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"

LONGEST_DAYS = 36_500


def positive_days(text: str) -> timedelta:
    """`90`, `0.5`."""
    days = float(text)
    if not 0 < days <= LONGEST_DAYS:
        raise argparse.ArgumentTypeError(f"{text} is not between 0 and {LONGEST_DAYS}")
    return timedelta(days=days)


def whole_number(text: str) -> int:
    """Zero or more."""
    number = int(text)
    if number < 0:
        raise argparse.ArgumentTypeError(f"{text} is less than 0")
    return number
