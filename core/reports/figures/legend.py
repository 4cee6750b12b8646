"""What colours mean, told in columns: a stroke or a ring, and a name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.path import Path

from core.reports.figures.canvas import PLAIN, Sheet, circle_path
from core.reports.figures.paragraph import Paragraph

# in sizes of the letters
RIM, HANDLE, GAP, BETWEEN_COLUMNS, LINE = 0.4, 2.0, 0.8, 2.0, 1.5
MIDDLE = 0.35  # above the baseline
STROKE_PT, RING_PT, RING_WIDTH_PT = 2.0, 6.0, 1.0
LEVEL = 5.0


@dataclass(frozen=True, slots=True)
class Entry:
    """A name with its colour as `#rrggbb`."""

    name: str
    colour: str
    sign: Literal["stroke", "ring"] = "stroke"


def draw_entries(sheet: Sheet, entries: Sequence[Entry], left_px: float, top_px: float, columns: int = 1) -> None:
    """Column by column; left_px, top_px: upper left corner, a rim stays free."""
    em = PLAIN.size_pt * sheet.pixels_per_point
    left = left_px + 2 * RIM * em
    for numbers in np.array_split(np.arange(len(entries)), min(columns, max(1, len(entries)))):
        column = [entries[number] for number in numbers]
        words = [Paragraph.of(entry.name, PLAIN, sheet.dpi) for entry in column]
        for line, (entry, paragraph) in enumerate(zip(column, words, strict=True)):
            baseline = top_px - 2 * RIM * em - line * LINE * em + paragraph.baselines[0]
            _draw_sign(sheet, entry, left, baseline + MIDDLE * em, HANDLE * em)
            sheet.write(left + (HANDLE + GAP) * em, baseline, entry.name, level=LEVEL)
        left += max((paragraph.width for paragraph in words), default=0.0) + (HANDLE + GAP + BETWEEN_COLUMNS) * em


def entries_height_px(sheet: Sheet, count: int) -> float:
    """Of so many entries in one column, with the rim."""
    return ((count - 1) * LINE + 1.0 + 3 * RIM) * PLAIN.size_pt * sheet.pixels_per_point


def _draw_sign(sheet: Sheet, entry: Entry, left: float, middle: float, width: float) -> None:
    if entry.sign == "stroke":
        sheet.stroke(Path([(left, middle), (left + width, middle)]), entry.colour, STROKE_PT, level=LEVEL)
    else:
        ring = circle_path(left + 0.5 * width, middle, 0.5 * RING_PT * sheet.pixels_per_point)
        sheet.stroke(ring, entry.colour, RING_WIDTH_PT, level=LEVEL)
