import time
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime

import pytest
from integument.backoff import Backoff
from integument.errors import ProblemError, ServerUnreachableError
from integument.problem import Problem
from integument.retry_after import read_retry_after_s


def refusal(retry_after_s: float | None) -> ProblemError:
    return ProblemError(Problem(status=503, code="server.busy"), retry_after_s=retry_after_s)


def test_retry_after_is_honoured() -> None:
    start = time.monotonic()
    Backoff(1, 0.0).pause(refusal(0.2))
    assert time.monotonic() - start >= 0.2


def test_a_server_that_asks_for_an_hour_is_not_waited_for() -> None:
    with pytest.raises(ProblemError):
        Backoff(1, 0.0).pause(refusal(3600))


def test_pauses_grow_and_the_count_starts_again_when_something_arrived() -> None:
    backoff = Backoff(3, 0.02)
    error = ServerUnreachableError("http://x", "gone", untouched=False)
    took = []
    for _ in range(3):
        start = time.monotonic()
        backoff.pause(error)
        took.append(time.monotonic() - start)
    assert took[0] >= 0.01
    assert took[2] >= 0.04
    with pytest.raises(ServerUnreachableError):
        backoff.pause(error)
    backoff.reset()
    backoff.pause(error)


def test_what_must_not_happen_twice_is_only_repeated_when_it_did_not_happen() -> None:
    Backoff(1, 0.0).pause(ServerUnreachableError("http://x", "refused", untouched=True), repeatable=False)
    with pytest.raises(ServerUnreachableError):
        Backoff(1, 0.0).pause(ServerUnreachableError("http://x", "cut", untouched=False), repeatable=False)


@pytest.mark.parametrize(("header", "seconds"), [(None, None), ("", None), ("7", 7.0), ("soon", None), ("-3", None)])
def test_retry_after_in_seconds(header: str | None, seconds: float | None) -> None:
    assert read_retry_after_s(header) == seconds


def test_retry_after_as_a_date() -> None:
    later = format_datetime(datetime.now(UTC) + timedelta(seconds=30), usegmt=True)
    assert 25 < (read_retry_after_s(later) or 0) <= 30
    assert read_retry_after_s("Wed, 21 Oct 2015 07:28:00 GMT") == 0.0
