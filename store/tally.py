"""Counts on their way to the tables: for each family, its labels and its cells a sum."""

from __future__ import annotations

import json
import math
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from store.metric_family import MAX_SERIES, OTHER, Family
from store.storable import storable_text

COUNT = ""  # the only cell of a counter
SUM = "sum"
MAX_VALUE = 80  # characters of one label


@dataclass(frozen=True, slots=True)
class Cell:
    """Where a number belongs: a counter, the sum of a histogram, or one of its buckets, by number and not cumulative."""

    family: str
    labels: tuple[str, ...]
    cell: str = COUNT


class Tally:
    """What one transaction, or one process within seconds, has to add. Not thread-safe."""

    def __init__(self) -> None:
        self._sums: defaultdict[Cell, float] = defaultdict(float)

    def __bool__(self) -> bool:
        return bool(self._sums)

    def count(self, family: Family, *labels: str, number: float = 1.0) -> None:
        """Add to a counter."""
        self._sums[Cell(family.name, _plain(labels))] += number

    def observe(self, family: Family, *labels: str, value: float) -> None:
        """Add one value to a histogram; what is no finite number is left out, so that it spoils no write of a job."""
        if not math.isfinite(value):
            return
        plain = _plain(labels)
        self._sums[Cell(family.name, plain, str(bisect_left(family.buckets, value)))] += 1.0
        self._sums[Cell(family.name, plain, SUM)] += value

    def absorb(self, other: Tally) -> None:
        """Add all of another."""
        for cell, value in other._sums.items():
            self._sums[cell] += value

    def describe(self) -> list[list[Any]]:
        """JSON for a row."""
        return [[cell.family, list(cell.labels), cell.cell, value] for cell, value in self._sums.items()]


def read_cells(described: Iterable[Iterable[Any]]) -> Iterable[tuple[Cell, float]]:
    """The inverse of `Tally.describe`."""
    for family, labels, cell, value in described:
        yield Cell(family, tuple(labels), cell), float(value)


def merge(totals: Mapping[Cell, float], more: Iterable[tuple[Cell, float]]) -> dict[Cell, float]:
    """Only what changes: the cells of `more`, summed up, those of series beyond `MAX_SERIES` under `other`."""
    series: defaultdict[str, set[tuple[str, ...]]] = defaultdict(set)
    for cell in totals:
        series[cell.family].add(cell.labels)
    sums: defaultdict[Cell, float] = defaultdict(float)
    for cell, value in more:
        known = series[cell.family]
        if cell.labels not in known and len(known) >= MAX_SERIES:
            cell = Cell(cell.family, (OTHER,) * len(cell.labels), cell.cell)
        known.add(cell.labels)
        sums[cell] += value
    return dict(sums)


def labels_text(labels: tuple[str, ...]) -> str:
    """A key for a row."""
    return json.dumps(list(labels), ensure_ascii=False, separators=(",", ":"))


def labels_of(text: str) -> tuple[str, ...]:
    """The inverse."""
    return tuple(json.loads(text))


def _plain(labels: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(storable_text(label, MAX_VALUE) for label in labels)
