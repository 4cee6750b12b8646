"""Every subject ends ready, proven by the exact referee, or refused by name with places; nothing else gets out."""

from __future__ import annotations

from collections import Counter

import pytest

from subjects.corpus import CORPUS, Subject
from subjects.trial import READY, attempt

QUICK = [subject for subject in CORPUS if subject.cost == "quick"]
LONG = [subject for subject in CORPUS if subject.cost != "quick"]


def check(subject: Subject) -> None:
    trial = attempt(subject.make(), subject.depths_mm)
    assert trial.broken == ()
    assert subject.is_right(trial), trial


@pytest.mark.parametrize("subject", QUICK, ids=lambda subject: subject.name)
def test_quick_subject(subject: Subject) -> None:
    check(subject)


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("subject", LONG, ids=lambda subject: subject.name)
def test_long_subject(subject: Subject) -> None:
    check(subject)


def test_corpus_is_as_wide_as_asked() -> None:
    assert len(CORPUS) >= 40
    assert max(Counter(subject.name for subject in CORPUS).values()) == 1
    expected = Counter(subject.expected for subject in CORPUS)
    assert expected[READY] >= 40
    assert len(expected) >= 7
    assert {subject.expected for subject in QUICK} == set(expected)
