"""Waits between restarts."""

from server.backoff import Backoff, RestartPolicy

POLICY = RestartPolicy(first_s=0.5, longest_s=3.0, crashes=6, window_s=100.0)


def test_waits_double_up_to_the_longest_and_then_it_gives_up() -> None:
    backoff = Backoff(POLICY)
    assert [backoff.after_crash(float(now)) for now in range(6)] == [0.5, 1.0, 2.0, 3.0, 3.0, None]


def test_crashes_outside_the_window_are_forgotten() -> None:
    backoff = Backoff(POLICY)
    assert {backoff.after_crash(now * 101.0) for now in range(50)} == {0.5}
