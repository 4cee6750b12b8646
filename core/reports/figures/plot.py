"""Two axes on a sheet, with what is drawn between them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, Bbox
from numpy.typing import ArrayLike, NDArray

from core.reports.figures.canvas import AREAS, BEHIND, FAINT, Sheet, box_path
from core.reports.figures.lettering import Letters
from core.reports.figures.paragraph import Across, Up

Floats = NDArray[np.float64]
Box = tuple[float, float, float, float]
TICK_PT, GAP_PT, RIM_PT, GRID_PT = 3.5, 3.5, 0.6, 0.3
LABELS, TITLE = Letters(8.0), Letters(9.0, "bold")
LABEL_GAP_PT = 4.0
GRID_INK = 0.5  # opacity
RIM, IN_FRONT = 250.0, 300.0  # what is drawn last


class Plot:
    """A window of data on a box of a sheet.

    box: left, bottom, width and height as shares of the sheet, as matplotlib's axes take them. low, high: (2,) corners of the
    window in the units of the data. log_y: the vertical axis is logarithmic, low[1] > 0.
    """

    def __init__(self, sheet: Sheet, box: Box, low: ArrayLike, high: ArrayLike, *, log_y: bool = False) -> None:
        self.sheet = sheet
        width, height = sheet.width_px, sheet.height_px
        self.box = Bbox.from_bounds(box[0] * width, box[1] * height, box[2] * width, box[3] * height)
        self.low, self.high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
        self._log_y = log_y
        lowest, highest = self._straight(np.array([self.low, self.high]))
        scale = np.array([self.box.width, self.box.height]) / (highest - lowest)
        self.to_pixels = Affine2D().translate(*-lowest).scale(*scale).translate(self.box.x0, self.box.y0)
        self._pixels_per_point = sheet.pixels_per_point

    def line(self, x: ArrayLike, y: ArrayLike, colour: str, width_pt: float, *, dashed: bool = False) -> None:
        """Points joined by straight lines."""
        path = Path(self._straight(np.column_stack([x, y])))
        self.sheet.stroke(path, colour, width_pt, unit=self.to_pixels, window=self.box, dashed=dashed)

    def steps(self, edges: Floats, heights: Floats, colour: str, width_pt: float) -> None:
        """A histogram's outline: heights (N,) between edges (N + 1,)."""
        self.line(np.repeat(edges, 2)[1:-1], np.repeat(heights, 2), colour, width_pt)

    def bars(self, edges: Floats, heights: Floats, colour: str) -> None:
        """Bars from the lower end of the window to heights (N,), between edges (N + 1,)."""
        for left, right, height in zip(edges[:-1], edges[1:], heights, strict=True):
            if height > self.low[1]:
                self.band(left, right, colour, top=float(height), level=AREAS)

    def band(self, left: float, right: float, colour: str, *, top: float | None = None, level: float = 0.0) -> None:
        """A filled box over a stretch of the horizontal axis, as high as the window if no top is given."""
        end = self.high[1] if top is None else top
        corners = self._straight(np.array([[left, self.low[1]], [right, end]]))
        self.fill(box_path(*corners.ravel()), colour, level)

    def upright(self, x: float, colour: str, width_pt: float) -> None:
        """A line across the whole height."""
        self.line([x, x], [self.low[1], self.high[1]], colour, width_pt)

    def dot(self, x: float, y: float, colour: str, size_pt: float) -> None:
        """A filled circle, round whatever the scales."""
        self.sheet.dots(self.at(x, y), size_pt, colour, level=IN_FRONT)

    def fill(self, path: Path, colour: str, level: float) -> None:
        """The inside of a path in the units of the data."""
        self.sheet.fill(path, colour, level=level, unit=self.to_pixels, window=self.box)

    def outline(self, path: Path, colour: str, width_pt: float, level: float) -> None:
        """A path in the units of the data as a line."""
        self.sheet.stroke(path, colour, width_pt, level=level, unit=self.to_pixels, window=self.box, join="round")

    def rim(self, *, whole: bool = False, colour: str = FAINT, width_pt: float = RIM_PT) -> None:
        """The axes as lines: left and below, or all around."""
        box = self.box
        corners = [(box.x0, box.y1), (box.x0, box.y0), (box.x1, box.y0)]
        path = [*corners, (box.x1, box.y1), corners[0], corners[1]] if whole else corners
        self.sheet.stroke(Path(path), colour, width_pt, level=RIM)

    def ticks_x(self, values: Sequence[float], word: Callable[[float], str] | None) -> None:
        """Ticks below the axis with a word each; None leaves the words out."""
        inside = [value for value in values if self.low[0] <= value <= self.high[0]]
        end = self.box.y0 - TICK_PT * self._pixels_per_point
        across = [self.at(value, self.low[1])[0] for value in inside]
        self._strokes([((x, self.box.y0), (x, end)) for x in across], RIM_PT, RIM)
        for value, x in zip(inside, across, strict=True):
            if word is not None:
                below = end - GAP_PT * self._pixels_per_point
                self.sheet.write(x, below, word(value), across="center", up="top", letters=LABELS)

    def ticks_y(self, values: Sequence[float], word: Callable[[float], str], *, grid: bool = False) -> None:
        """Ticks left of the axis with a word each, and pale lines across the plot."""
        inside = [value for value in values if self.low[1] <= value <= self.high[1]]
        end = self.box.x0 - TICK_PT * self._pixels_per_point
        up = [self.at(self.low[0], value)[1] for value in inside]
        self._strokes([((self.box.x0, y), (end, y)) for y in up], RIM_PT, RIM)
        if grid:
            self._strokes([((self.box.x0, y), (self.box.x1, y)) for y in up], GRID_PT, BEHIND, GRID_INK)
        for value, y in zip(inside, up, strict=True):
            beside = end - GAP_PT * self._pixels_per_point
            self.sheet.write(beside, y, word(value), across="right", up="waist", letters=LABELS)

    def label_x(self, words: str) -> None:
        """What the horizontal axis means, below the words of its ticks."""
        below = TICK_PT + GAP_PT + LABELS.size_pt * 1.2 + LABEL_GAP_PT
        middle = 0.5 * (self.box.x0 + self.box.x1)
        self.sheet.write(middle, self.box.y0 - below * self._pixels_per_point, words, across="center", up="top", letters=LABELS)

    def label_y(self, words: str, room_pt: float) -> None:
        """What the vertical axis means, turned, `room_pt` left of the axis, beyond the words of its ticks."""
        place = self.box.x0 - room_pt * self._pixels_per_point, 0.5 * (self.box.y0 + self.box.y1)
        self.sheet.write(*place, words, across="right", up="center", letters=LABELS, upwards=True)

    def title(self, words: str, pad_pt: float = 5.0) -> None:
        """Bold, above the upper left corner."""
        above = self.box.y1 + pad_pt * self._pixels_per_point
        self.sheet.write(self.box.x0, above, words, letters=TITLE)

    def words(
        self, x: float, y: float, text: str, *, above_pt: float = 0.0, across: Across, up: Up, letters: Letters = LABELS,
        ground: bool = False,
    ) -> None:  # fmt: skip
        """Text at a place of the data, or so many points above it."""
        column, row = self.at(x, y)
        row += above_pt * self._pixels_per_point
        self.sheet.write(column, row, text, across=across, up=up, letters=letters, level=IN_FRONT, ground=ground)

    def at(self, x: float, y: float) -> tuple[float, float]:
        """Pixels of the sheet, from its lower left corner."""
        across, up = self.to_pixels.transform(self._straight(np.array([[x, y]])))[0]
        return float(across), float(up)

    def _straight(self, points: Floats) -> Floats:
        """Points (N, 2) with the logarithm of what is on a logarithmic axis."""
        if not self._log_y:
            return points
        straight: Floats = np.column_stack([points[:, 0], np.log10(points[:, 1])])
        return straight

    def _strokes(
        self,
        lines: Sequence[tuple[tuple[float, float], tuple[float, float]]],
        width_pt: float,
        level: float,
        opacity: float = 1.0,
    ) -> None:
        """Ticks and lines of a grid, in pixels."""
        if lines:
            codes = [Path.MOVETO, Path.LINETO] * len(lines)
            path = Path(np.array(lines).reshape(-1, 2), codes)
            self.sheet.stroke(path, FAINT, width_pt, level=level, opacity=opacity)


def round_values(low: float, high: float, most: int, *, whole: bool = False) -> list[float]:
    """Round numbers between low and high, at most about `most` of them."""
    locator = MaxNLocator(nbins=most, steps=[1, 2, 5, 10], integer=whole)
    slack = 1e-9 * (high - low)
    return [float(value) for value in locator.tick_values(low, high) if low - slack <= value <= high + slack]
