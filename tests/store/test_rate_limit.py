"""Token buckets in a real Valkey."""

from __future__ import annotations

import signal
import threading
import time

import pytest

from store import rate_limit
from store.rate_limit import Allowance, RateLimiter
from store.workspace import WorkspaceId
from tests.valkey import ValkeyServer

LAB, OTHER = WorkspaceId("lab"), WorkspaceId("other")


def allowed(taken: Allowance | None) -> bool:
    assert taken is not None
    return taken.allowed


class Clock:
    """Stands still until told otherwise."""

    def __init__(self) -> None:
        self.now_s = 1_700_000_000.0

    def __call__(self) -> float:
        return self.now_s


def test_a_burst_passes_then_the_rate_holds(valkey: ValkeyServer) -> None:
    limiter = RateLimiter(valkey.url, per_s=0.5, burst=5, now_s=Clock())
    taken = [limiter.take(LAB) for _ in range(7)]
    assert taken == [Allowance(True, 5, 0.5, left) for left in (4.0, 3.0, 2.0, 1.0, 0.0)] + [Allowance(False, 5, 0.5, 0.0)] * 2
    first, last = taken[0], taken[-1]
    assert first is not None
    assert last is not None
    assert (first.remaining, first.window_s, first.reset_s) == (4, 10, 2)
    assert (last.remaining, last.reset_s, last.retry_after_s) == (0, 10, 2)
    assert limiter.take(OTHER) == Allowance(True, 5, 0.5, 4.0), "each workspace has a bucket of its own"
    limiter.close()


def test_the_bucket_fills_with_time_and_not_beyond_its_rim(valkey: ValkeyServer) -> None:
    clock = Clock()
    limiter = RateLimiter(valkey.url, per_s=0.5, burst=2, now_s=clock)
    assert [allowed(limiter.take(LAB)) for _ in range(3)] == [True, True, False]
    clock.now_s += 1.5
    assert limiter.take(LAB) == Allowance(False, 2, 0.5, 0.75)
    clock.now_s += 0.5
    assert limiter.take(LAB) == Allowance(True, 2, 0.5, 0.0)
    clock.now_s += 3600.0
    assert limiter.take(LAB) == Allowance(True, 2, 0.5, 1.0)
    clock.now_s -= 3600.0
    assert limiter.take(LAB) == Allowance(True, 2, 0.5, 0.0), "a clock that goes back takes nothing away"
    limiter.close()


def test_without_a_clock_the_bucket_goes_by_that_of_valkey(valkey: ValkeyServer) -> None:
    limiter = RateLimiter(valkey.url, per_s=1000.0, burst=1)
    assert allowed(limiter.take(LAB))
    deadline = time.monotonic() + 10
    while not allowed(limiter.take(LAB)):
        assert time.monotonic() < deadline, "no token comes back"
    limiter.close()


def test_processes_share_a_bucket(valkey: ValkeyServer) -> None:
    limiters = [RateLimiter(valkey.url, per_s=0.001, burst=40) for _ in range(4)]
    outcomes: list[bool] = []

    def send(limiter: RateLimiter) -> None:
        outcomes.extend(allowed(limiter.take(LAB)) for _ in range(20))

    threads = [threading.Thread(target=send, args=(limiter,)) for limiter in limiters]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert outcomes.count(True) == 40
    for limiter in limiters:
        limiter.close()


def test_a_valkey_that_is_away_stops_nobody_and_costs_little(valkey: ValkeyServer, monkeypatch: pytest.MonkeyPatch) -> None:
    limiter = RateLimiter(valkey.url, per_s=0.001, burst=1)
    valkey.signal(signal.SIGSTOP)
    asked = time.monotonic()
    assert [limiter.take(LAB) for _ in range(50)] == [None] * 50
    assert time.monotonic() - asked < 10 * rate_limit.TIMEOUT_S
    valkey.signal(signal.SIGCONT)
    valkey.kill()
    valkey.start()
    monkeypatch.setattr(limiter, "_quiet_until", 0.0)
    assert [allowed(limiter.take(LAB)) for _ in range(2)] == [True, False]
    limiter.close()


def test_no_rate_no_count() -> None:
    limiter = RateLimiter("redis://127.0.0.1:1/0", per_s=0.0, burst=1)
    assert limiter.take(LAB) is None
    limiter.close()
