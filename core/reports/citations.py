"""Methods and their references as a paper has them: numbered in the order they are cited."""

from __future__ import annotations

import re

from core.schema.report import Report, StepReport

CITATION = re.compile(r"\[(\d+)\]")
NUMBER = re.compile(r"^\[(\d+)\]\s*")


def in_order_of_citation(report: Report | StepReport) -> tuple[str, tuple[str, ...]]:
    """(methods, references): the first work cited is [1].

    A numbered work that the text does not cite is left out; one without a number stays, at the end."""
    numbered = {int(found[1]): NUMBER.sub("", work) for work in report.references if (found := NUMBER.match(work))}
    others = tuple(work for work in report.references if not NUMBER.match(work))
    cited = dict.fromkeys(int(number) for number in CITATION.findall(report.methods) if int(number) in numbered)
    place = {number: order for order, number in enumerate(cited, 1)}
    text = CITATION.sub(lambda found: f"[{place[int(found[1])]}]" if int(found[1]) in place else found[0], report.methods)
    return text, (*(f"[{place[number]}] {numbered[number]}" for number in cited), *others)
