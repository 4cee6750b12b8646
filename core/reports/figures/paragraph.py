"""Lines of words laid out beside a place: the boxes and baselines of matplotlib's text."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.reports.figures.lettering import Lettering, Letters, letter

Across = Literal["left", "center", "right"]
Up = Literal["top", "center", "bottom", "baseline", "waist"]  # waist: the middle of what stands on the baseline
SHARES: dict[Across, float] = {"left": 0.0, "center": 0.5, "right": 1.0}


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Lines, one below the other, in a box whose upper left corner is the origin; lengths in pixels.

    baselines: height of each line in the box, all negative. upwards: turned to the left, as the words of an upright axis."""

    lines: tuple[Lettering, ...]
    baselines: tuple[float, ...]
    upwards: bool

    @classmethod
    def of(cls, words: str, letters: Letters, dpi: float, *, upwards: bool = False) -> Paragraph:
        """A line for every line of the words."""
        lines = tuple(letter(line, letters, dpi) for line in words.split("\n"))
        baselines, height = [], 0.0
        for line in lines:
            half_gap = 0.5 * line.gap if len(lines) > 1 else 0.0
            height -= line.ascent + half_gap
            baselines.append(height)
            height -= line.descent + half_gap
        return cls(lines, tuple(baselines), upwards)

    @property
    def width(self) -> float:
        """Of the longest line."""
        return max(line.width for line in self.lines)

    @property
    def bottom(self) -> float:
        """Lower end of the box, negative."""
        last = self.lines[-1]
        return self.baselines[-1] - last.descent - (0.5 * last.gap if len(self.lines) > 1 else 0.0)

    def box(self, x: float, y: float, across: Across, up: Up) -> tuple[float, float, float, float]:
        """Left, bottom, right and top of level words at a place."""
        left, top = x - SHARES[across] * self.width, y - self._anchor(up)
        return left, top + self.bottom, left + self.width, top

    def pictures(self, x: float, y: float, across: Across, up: Up) -> Iterator[tuple[NDArray[np.uint8], int, int]]:
        """(shape, left, bottom) of every line at a place, in whole pixels so that letters stay sharp."""
        for line, baseline in zip(self.lines, self.baselines, strict=True):
            indent = SHARES[across] * (self.width - line.width)
            if self.upwards:
                right = x + SHARES[across] * self.bottom - baseline
                start = y - {"top": 1.0, "bottom": 0.0}.get(up, 0.5) * self.width + indent
                turned = np.ascontiguousarray(np.rot90(line.shape))
                yield turned, round(right + line.ink_descent) + 1 - turned.shape[1], round(start + line.left)
            else:
                left = x - SHARES[across] * self.width + indent
                ground = y - self._anchor(up) + baseline
                yield line.shape, round(left + line.left), round(ground - line.below - line.ink_descent) - 1

    def _anchor(self, up: Up) -> float:
        """Height in the box of what lies at the place."""
        heights = {"top": 0.0, "center": 0.5 * self.bottom, "bottom": self.bottom, "baseline": self.baselines[-1]}
        return heights.get(up, 0.5 * self.baselines[-1])
