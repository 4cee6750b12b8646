"""The parts of a report made of several steps: figures that know their step, methods that read as one text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from core.reports.citations import NUMBER, renumbered
from core.reports.figures.figure import Figure
from core.schema.report import StepReport


def figures_of_step(step: str, figures: Sequence[Figure]) -> tuple[Figure, ...]:
    """The same figures for the section of `step`, a StepReport's name; their names get it in front, so that they stay unique."""
    return tuple(replace(figure, name=f"{step}_{figure.name}", step=step) for figure in figures)


def joined_methods(steps: Sequence[StepReport]) -> tuple[str, tuple[str, ...]]:
    """(methods, references) of all steps that were done and have any, in order.

    Promises: a work cited by several steps stands once, numbered by first appearance; `[n]` in the text is its entry.
    """
    order: dict[str, int] = {}
    texts = []
    for step in steps:
        if not step.methods or step.outcome != "done":
            continue
        works = [NUMBER.sub("", reference) for reference in step.references]
        numbers = [order.setdefault(work, len(order) + 1) for work in works]
        texts.append(_with_numbers(step.methods, numbers))
    return " ".join(texts), tuple(f"[{number}] {work}" for work, number in order.items())


def _with_numbers(text: str, numbers: Sequence[int]) -> str:
    """numbers: for each work of the step, that of the whole; brackets that cite none of them stay."""
    return renumbered(text, lambda own: numbers[own - 1] if 1 <= own <= len(numbers) else own)
