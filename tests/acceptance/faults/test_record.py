"""What must not be is told, and what was counted is in the table."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from tests.acceptance.faults.census import Census
from tests.acceptance.faults.plan import draw_plan
from tests.acceptance.faults.record import complaints, describe_run, table, write_record


def test_a_run_without_anything_wrong_has_no_complaints() -> None:
    assert complaints(Census(requests=3, accepted=3, by_status=Counter({"successful": 3}))) == []


@pytest.mark.parametrize("name", sorted(Census().wrong()))
def test_anything_wrong_is_a_complaint_and_counted(name: str) -> None:
    census = Census()
    census.wrong()[name].append("job 7")
    assert complaints(census) == [f"{name}: job 7"]
    assert f"| {name} | 1 |" in table(draw_plan(1, 5, 1.0, 2), census, Counter(), 0, Counter(), 1.0)


def test_the_record_can_be_read(tmp_path: Path) -> None:
    census = Census(by_attempts=Counter({1: 4, 2: 1}), recovered_s=[31.0, 35.5])
    parts = (draw_plan(1, 5, 1.0, 2), census, Counter({"kill api": 2}), 1, Counter({"no answer": 3}), 12.3)
    write_record(tmp_path / "out", 1, describe_run(*parts), table(*parts))
    told = json.loads((tmp_path / "out" / "1.json").read_text())
    assert (told["seed"], told["faults"], told["by_attempts"]) == (1, {"kill api": 2}, {"1": 4, "2": 1})
    assert "33.2 s in the middle, 35.5 s at most, of 2" in (tmp_path / "out" / "1.md").read_text()
