"""Two axes on a sheet, drawn straight onto it: making matplotlib's own takes longer than drawing all that is on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure as Sheet
from matplotlib.patches import Circle, PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, Bbox, IdentityTransform
from numpy.typing import ArrayLike, NDArray

from core.reports.figures.canvas import FAINT, INK

Floats = NDArray[np.float64]
Box = tuple[float, float, float, float]
POINTS_PER_INCH = 72.0
TICK_PT, GAP_PT, RIM_PT, GRID_PT = 3.5, 3.5, 0.6, 0.3
LABEL_PT, TITLE_PT = 8.0, 9.0
LABEL_GAP_PT = 4.0
GRID_INK = 0.5  # opacity
BEHIND, RIM, IN_FRONT = -10, 250, 300  # what is drawn first and last


class Plot:
    """A window of data on a box of a sheet.

    box: left, bottom, width and height as shares of the sheet, as matplotlib's axes take them. low, high: (2,) corners of the
    window in the units of the data. log_y: the vertical axis is logarithmic, low[1] > 0.
    """

    def __init__(self, figure: Sheet, box: Box, low: ArrayLike, high: ArrayLike, *, log_y: bool = False) -> None:
        self.figure = figure
        width, height = figure.bbox.width, figure.bbox.height
        self.box = Bbox.from_bounds(box[0] * width, box[1] * height, box[2] * width, box[3] * height)
        self.low, self.high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
        self._log_y = log_y
        lowest, highest = self._straight(np.array([self.low, self.high]))
        scale = np.array([self.box.width, self.box.height]) / (highest - lowest)
        self.to_pixels = Affine2D().translate(*-lowest).scale(*scale).translate(self.box.x0, self.box.y0)
        self._pixels_per_point = figure.dpi / POINTS_PER_INCH

    def line(self, x: ArrayLike, y: ArrayLike, colour: str, width_pt: float, *, style: str = "-") -> None:
        """Points joined by straight lines."""
        path = Path(self._straight(np.column_stack([x, y])))
        self._add(PathPatch(path, facecolor="none", edgecolor=colour, linewidth=width_pt, linestyle=style, zorder=2))

    def steps(self, edges: Floats, heights: Floats, colour: str, width_pt: float) -> None:
        """A histogram's outline: heights (N,) between edges (N + 1,)."""
        self.line(np.repeat(edges, 2)[1:-1], np.repeat(heights, 2), colour, width_pt)

    def bars(self, edges: Floats, heights: Floats, colour: str) -> None:
        """Bars from the lower end of the window to heights (N,), between edges (N + 1,)."""
        for left, right, height in zip(edges[:-1], edges[1:], heights, strict=True):
            if height > self.low[1]:
                self.band(left, right, colour, top=float(height), zorder=1)

    def band(self, left: float, right: float, colour: str, *, top: float | None = None, zorder: float = 0) -> None:
        """A filled box over a stretch of the horizontal axis, as high as the window if no top is given."""
        end = self.high[1] if top is None else top
        corners = self._straight(np.array([[left, self.low[1]], [right, end]]))
        size = corners[1] - corners[0]
        self._add(Rectangle(tuple(corners[0]), *size, facecolor=colour, edgecolor="none", linewidth=0, zorder=zorder))

    def upright(self, x: float, colour: str, width_pt: float) -> None:
        """A line across the whole height."""
        self.line([x, x], [self.low[1], self.high[1]], colour, width_pt)

    def dot(self, x: float, y: float, colour: str, size_pt: float) -> None:
        """A filled circle, round whatever the scales."""
        centre = self.at(x, y)
        radius = 0.5 * size_pt * self._pixels_per_point
        self.figure.add_artist(Circle(centre, radius, transform=IdentityTransform(), color=colour, linewidth=0, zorder=IN_FRONT))

    def fill(self, path: Path, colour: str, zorder: float) -> None:
        """The inside of a path in the units of the data."""
        self._add(PathPatch(path, facecolor=colour, edgecolor="none", zorder=zorder))

    def outline(self, path: Path, colour: str, width_pt: float, zorder: float) -> None:
        """A path in the units of the data as a line."""
        style = {"facecolor": "none", "edgecolor": colour, "linewidth": width_pt, "joinstyle": "round"}
        self._add(PathPatch(path, zorder=zorder, **style))

    def rim(self, *, whole: bool = False, colour: str = FAINT, width_pt: float = RIM_PT) -> None:
        """The axes as lines: left and below, or all around."""
        box = self.box
        corners = [(box.x0, box.y1), (box.x0, box.y0), (box.x1, box.y0)]
        path = [*corners, (box.x1, box.y1), corners[0], corners[1]] if whole else corners
        self._add_pixels([path], colour, width_pt, RIM)

    def ticks_x(self, values: Sequence[float], word: Callable[[float], str] | None) -> None:
        """Ticks below the axis with a word each; None leaves the words out."""
        inside = [value for value in values if self.low[0] <= value <= self.high[0]]
        end = self.box.y0 - TICK_PT * self._pixels_per_point
        across = [self.at(value, self.low[1])[0] for value in inside]
        self._add_pixels([[(x, self.box.y0), (x, end)] for x in across], FAINT, RIM_PT, RIM)
        for value, x in zip(inside, across, strict=True):
            if word is not None:
                self._write(x, end - GAP_PT * self._pixels_per_point, word(value), ha="center", va="top", fontsize=LABEL_PT)

    def ticks_y(self, values: Sequence[float], word: Callable[[float], str], *, grid: bool = False) -> None:
        """Ticks left of the axis with a word each, and pale lines across the plot."""
        inside = [value for value in values if self.low[1] <= value <= self.high[1]]
        end = self.box.x0 - TICK_PT * self._pixels_per_point
        up = [self.at(self.low[0], value)[1] for value in inside]
        self._add_pixels([[(self.box.x0, y), (end, y)] for y in up], FAINT, RIM_PT, RIM)
        if grid:
            lines = [[(self.box.x0, y), (self.box.x1, y)] for y in up]
            self._add_pixels(lines, FAINT, GRID_PT, BEHIND, alpha=GRID_INK)
        for value, y in zip(inside, up, strict=True):
            self._write(
                end - GAP_PT * self._pixels_per_point, y, word(value), ha="right", va="center_baseline", fontsize=LABEL_PT
            )

    def label_x(self, words: str) -> None:
        """What the horizontal axis means, below the words of its ticks."""
        below = TICK_PT + GAP_PT + LABEL_PT * 1.2 + LABEL_GAP_PT
        middle = 0.5 * (self.box.x0 + self.box.x1)
        self._write(middle, self.box.y0 - below * self._pixels_per_point, words, ha="center", va="top", fontsize=LABEL_PT)

    def label_y(self, words: str, room_pt: float) -> None:
        """What the vertical axis means, turned, `room_pt` left of the axis, beyond the words of its ticks."""
        place = self.box.x0 - room_pt * self._pixels_per_point, 0.5 * (self.box.y0 + self.box.y1)
        self._write(*place, words, ha="right", va="center", rotation=90, fontsize=LABEL_PT)

    def title(self, words: str, pad_pt: float = 5.0) -> None:
        """Bold, above the upper left corner."""
        above = self.box.y1 + pad_pt * self._pixels_per_point
        self._write(self.box.x0, above, words, ha="left", va="baseline", fontsize=TITLE_PT, fontweight="bold")

    def words(self, x: float, y: float, text: str, shift_pt: tuple[float, float], **style: Any) -> None:
        """Text at a place of the data, moved by points; style as matplotlib's."""
        across, up = self.at(x, y)
        shift = np.array(shift_pt) * self._pixels_per_point
        self._write(across + float(shift[0]), up + float(shift[1]), text, zorder=IN_FRONT, **style)

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

    def _add(self, artist: PathPatch | Rectangle) -> None:
        artist.set_transform(self.to_pixels)
        artist.set_clip_box(self.box)
        self.figure.add_artist(artist)

    def _add_pixels(
        self, lines: Sequence[Sequence[tuple[float, float]]], colour: str, width_pt: float, zorder: float, alpha: float = 1.0
    ) -> None:
        style: dict[str, Any] = {"colors": colour, "linewidths": width_pt, "alpha": alpha, "zorder": zorder, "capstyle": "butt"}
        self.figure.add_artist(LineCollection(lines, transform=IdentityTransform(), **style))

    def _write(self, x: float, y: float, words: str, **style: Any) -> None:
        self.figure.add_artist(Text(x, y, words, transform=IdentityTransform(), **{"color": INK, **style}))


def round_values(low: float, high: float, most: int, *, whole: bool = False) -> list[float]:
    """Round numbers between low and high, at most about `most` of them."""
    locator = MaxNLocator(nbins=most, steps=[1, 2, 5, 10], integer=whole)
    slack = 1e-9 * (high - low)
    return [float(value) for value in locator.tick_values(low, high) if low - slack <= value <= high + slack]
