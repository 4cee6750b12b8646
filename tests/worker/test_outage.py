from __future__ import annotations

import pytest

from core.errors import InternalError, StateError
from worker.outage import sit_out


def test_an_act_is_repeated_until_the_database_is_back() -> None:
    tries = []

    def act() -> str:
        tries.append(1)
        if len(tries) < 3:
            raise InternalError("database.unavailable", "away")
        return "done"

    assert sit_out(act) == "done"
    assert len(tries) == 3


def test_patience_ends() -> None:
    def act() -> None:
        raise InternalError("database.unavailable", "away")

    with pytest.raises(InternalError, match="away"):
        sit_out(act, patience_s=0.6)


def test_other_errors_are_not_repeated() -> None:
    tries = []

    def act() -> None:
        tries.append(1)
        raise StateError("job.not_found", "gone")

    with pytest.raises(StateError):
        sit_out(act)
    assert len(tries) == 1
