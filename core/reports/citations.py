"""Methods and their references as a paper has them: numbered in the order they are cited."""

from __future__ import annotations

import re
from collections.abc import Callable

from core.schema.report import Report, StepReport

CITATION = re.compile(r"\[(\d+(?:, \d+)*)\]")  # one work or several
NUMBER = re.compile(r"^\[(\d+)\]\s*")


def in_order_of_citation(report: Report | StepReport) -> tuple[str, tuple[str, ...]]:
    """(methods, references): the first work cited is [1].

    A numbered work that the text does not cite is left out; one without a number stays, at the end."""
    numbered = {int(found[1]): NUMBER.sub("", work) for work in report.references if (found := NUMBER.match(work))}
    others = tuple(work for work in report.references if not NUMBER.match(work))
    cited = dict.fromkeys(
        number for group in CITATION.findall(report.methods) for number in _numbers(group) if number in numbered
    )
    place = {number: order for order, number in enumerate(cited, 1)}
    text = renumbered(report.methods, lambda number: place.get(number, number))
    return text, (*(f"[{place[number]}] {numbered[number]}" for number in cited), *others)


def renumbered(text: str, number_of: Callable[[int], int]) -> str:
    """The text with every number of every citation replaced."""
    return CITATION.sub(lambda found: f"[{', '.join(map(str, sorted(map(number_of, _numbers(found[1])))))}]", text)


def _numbers(group: str) -> list[int]:
    return [int(number) for number in group.split(", ")]
