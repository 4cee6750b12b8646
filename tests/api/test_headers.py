"""The headers we read ourselves."""

from __future__ import annotations

import pytest

from api.negotiation import prefers
from api.preferences import Preferences, read_preferences


@pytest.mark.parametrize(
    ("lines", "wait_s", "respond_async"),
    [
        ([], 0, False),
        (["respond-async"], 0, True),
        (["respond-async, wait=10"], 10, True),
        (["wait=5", "Respond-Async"], 5, True),
        (["wait = 7; x=y, return=minimal"], 7, False),
        (['wait="8"'], 8, False),
        (["wait=3, wait=9"], 3, False),
        (["wait=86400"], 30, False),
        (["wait=-1", "wait=1.5", "wait", "wait=", "wait=9999999999", "respond-sync", ",,;"], 0, False),
    ],
)
def test_prefer(lines: list[str], wait_s: int, respond_async: bool) -> None:
    assert read_preferences(lines) == Preferences(wait_s, respond_async)


def test_only_what_was_honoured_is_confirmed() -> None:
    assert Preferences().applied() == {}
    assert Preferences(5, True).applied() == {"Preference-Applied": "respond-async, wait=5"}


def test_the_most_specific_range_counts() -> None:
    assert not prefers("text/html;q=0.1, text/*;q=0.9, */*;q=0.5", "text/html", "application/json")
    assert prefers("text/*;q=0.9, */*;q=0.5", "text/html", "application/json")
    assert not prefers(None, "text/html", "application/json")
