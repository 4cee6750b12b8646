"""One leads at a time; who dies or is paused is followed by another once its lease is over."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

from store.database import Database
from store.leadership import Leadership

LEASE_S = 0.4


def test_one_of_many_leads_and_keeps_leading(db: Database) -> None:
    candidates = [Leadership(db, "reconciler", f"host:{number}", 30) for number in range(8)]
    with ThreadPoolExecutor(8) as pool:
        elected = list(pool.map(Leadership.campaign, candidates))
    assert elected.count(True) == 1
    leader = candidates[elected.index(True)]
    assert leader.campaign()
    assert [candidate.campaign() for candidate in candidates] == elected
    assert Leadership(db, "another office", "host:1", 30).campaign()


def test_another_follows_when_the_lease_is_over(db: Database) -> None:
    first, second = (Leadership(db, "reconciler", name, LEASE_S) for name in "ab")
    assert first.campaign()
    assert not second.campaign()
    deadline = time.monotonic() + 30
    while not second.campaign():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert not first.campaign(), "who wakes up finds the office taken"


def test_who_resigns_is_followed_at_once(db: Database) -> None:
    first, second = (Leadership(db, "reconciler", name, 3600) for name in "ab")
    assert first.campaign()
    second.resign()  # is not its to give
    assert not second.campaign()
    first.resign()
    assert second.campaign()
    assert not first.campaign()
