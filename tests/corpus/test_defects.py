"""Every defective surface is healed, by the exact referee and near the healthy one, or refused by name; none comes out wrong."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from core.validation.validate import validate
from subjects.damage.healthy import BALL
from subjects.defects import CORPUS, Defective
from subjects.generated.revolved import ball
from subjects.healing_trial import attempt_healing, judge_healing
from subjects.trial import READY

QUICK = [entry for entry in CORPUS if entry.quick]
LONG = [entry for entry in CORPUS if not entry.quick]


def check(entry: Defective) -> None:
    trial = attempt_healing(entry)
    assert trial.outcome == READY, trial


@pytest.mark.parametrize("entry", QUICK, ids=lambda entry: entry.name)
def test_quick_entry(entry: Defective) -> None:
    check(entry)


@pytest.mark.slow
@pytest.mark.parametrize("entry", LONG, ids=lambda entry: entry.name)
def test_long_entry(entry: Defective) -> None:
    check(entry)


def test_corpus_is_as_wide_as_asked() -> None:
    assert len(CORPUS) >= 120
    assert max(Counter(entry.name for entry in CORPUS).values()) == 1
    classes = Counter(kind for entry in CORPUS for kind in entry.classes)
    assert len(classes) >= 18
    assert set(classes) == {kind for entry in QUICK for kind in entry.classes} | {"staircase", "crease_holes"}
    for subject in ("body", "head", "hand", "ball"):
        assert sum(entry.name.startswith(f"{subject}, ") for entry in CORPUS) >= 30
    assert sum(len(entry.classes) > 1 for entry in CORPUS) >= 25


def test_entries_come_out_alike() -> None:
    for entry in QUICK[:3]:
        first, second = entry.make(), entry.make()
        assert first.vertices.tobytes() == second.vertices.tobytes()
        assert first.faces.tobytes() == second.faces.tobytes()


def test_what_nothing_was_done_to_is_wrong() -> None:
    """The judge must see each defect."""
    for entry in QUICK:
        if entry.name.startswith("body"):
            continue  # the same defects as on smaller ones
        damaged = entry.make()
        fit = validate({"damaged": damaged}).verdict == "simulation_ready"
        assert judge_healing(entry, damaged, damaged).broken, entry.name
        assert not fit or "debris" in entry.classes, entry.name


def test_judge_sees_what_is_off() -> None:
    entry = next(entry for entry in CORPUS if entry.name == "ball, doubled faces")
    damaged, healthy = entry.make(), BALL.mesh()
    assert judge_healing(entry, damaged, healthy).broken == ()
    assert judge_healing(entry, damaged, healthy).kept == 1.0
    larger = healthy.with_vertices(healthy.vertices * 1.001).rounded_to_float32()
    assert "0.03 mm off" in judge_healing(entry, damaged, larger).broken[0]
    assert judge_healing(entry, damaged, larger).kept < 0.01
    hollow = validate({"a": ball(5, 1)})
    assert hollow.verdict == "simulation_ready"
    assert np.isclose(judge_healing(entry, damaged, ball(5, 1)).deviation_mm, 25, atol=0.5)
