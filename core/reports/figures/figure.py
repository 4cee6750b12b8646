"""A finished picture with its words."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Figure:
    """`name` is the file name without `.png` and unique in its report; `caption` says what to see, with numbers and units.

    step: name of the step of the report whose section shows it; empty: the section of all figures.
    """

    name: str
    title: str
    caption: str
    png: bytes
    step: str = ""
