"""Connections by address: who is one, and when there is room again."""

from __future__ import annotations

import pytest

from api.crowd import Crowd

MAPPED = "::ffff:192.0.2.1"


@pytest.mark.parametrize(
    ("first", "second", "is_the_same"),
    [
        ("192.0.2.1", "192.0.2.1", True),
        ("192.0.2.1", "192.0.2.2", False),
        ("2001:db8::1", "2001:db8::ffff:1", True),
        ("2001:db8::1", "2001:db8:0:1::1", False),
        (MAPPED, "192.0.2.1", True),
        (MAPPED, "::ffff:192.0.2.2", False),
        ("", "", True),
    ],
)
def test_who_counts_as_one(first: str, second: str, is_the_same: bool) -> None:
    crowd = Crowd(most=0, most_of_one=1)
    assert crowd.enter(first)
    assert crowd.enter(second) != is_the_same


def test_who_was_refused_takes_no_place() -> None:
    crowd = Crowd(most=2, most_of_one=0)
    assert [crowd.enter(f"192.0.2.{number}") for number in range(3)] == [True, True, False]
    crowd.leave("192.0.2.2")
    assert not crowd.enter("192.0.2.3"), "it is full all the same"
    crowd.leave("192.0.2.3")
    crowd.leave("192.0.2.0")
    assert crowd.enter("192.0.2.3")
