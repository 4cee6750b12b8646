"""Paper to draw on: pictures, areas, strokes and words, in the end a PNG.

Drawn by Agg as matplotlib has it, but without its figures, artists and settings: making those takes longer than drawing them,
and a site's settings must not change a report."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from matplotlib.backend_bases import GraphicsContextBase
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.colors import to_rgba
from matplotlib.path import Path
from matplotlib.transforms import Bbox, IdentityTransform, Transform
from numpy.typing import ArrayLike, NDArray

from core.reports.figures.lettering import POINTS_PER_INCH, Letters
from core.reports.figures.paragraph import Across, Paragraph, Up
from core.reports.figures.png import encode_png

DPI = 150
INK = "#22262b"
FAINT = "#8a9099"
PAPER = "#ffffff"
PLAIN = Letters()
PIXELS = IdentityTransform()
BEHIND, AREAS, STROKES, WORDS = -10.0, 1.0, 2.0, 3.0  # what covers what, unless told otherwise
GROUND_RIM_PT, GROUND_OPACITY = 0.8, 0.75
DASH, PAUSE = 3.7, 1.6  # in widths of the stroke
LONG = 128  # corners of a stroke; of those of a longer one
SIMPLER_PX = 1.0 / 9.0  # which stand out by less are left out

Join = Literal["miter", "round"]


class Sheet:
    """Pixels count from the lower left corner; sizes in inches and points as printers have them.

    Whatever is put on it lies above what has a smaller `level` and, among equals, what came before; pictures are the ground."""

    def __init__(self, width_in: float, height_in: float, dpi: float = DPI) -> None:
        self.dpi = dpi
        self.width_px, self.height_px = int(width_in * dpi), int(height_in * dpi)
        self.pixels_per_point = dpi / POINTS_PER_INCH
        self._pictures: list[tuple[NDArray[np.uint8], int, int]] = []
        self._drawn: list[tuple[float, Callable[[Any], None]]] = []

    def place(self, picture: NDArray[np.uint8], left_px: int, bottom_px: int) -> None:
        """An opaque picture (H, W, 4), row 0 at the top, pixel for pixel; what lies beyond the sheet is not shown."""
        self._pictures.append((picture, left_px, bottom_px))

    def fill(
        self,
        path: Path,
        colour: str,
        *,
        level: float = AREAS,
        unit: Transform = PIXELS,
        window: Bbox | None = None,
        opacity: float = 1.0,
    ) -> None:
        """The inside of a path. unit: from what it is measured in to pixels; window: in pixels, nothing is drawn beyond."""
        face = to_rgba(colour, opacity)
        pen = _pen(window)
        pen.set_linewidth(0.0)
        self._drawn.append((level, lambda agg: agg.draw_path(pen, path, unit, face)))

    def stroke(
        self,
        path: Path,
        colour: str,
        width_pt: float,
        *,
        level: float = STROKES,
        unit: Transform = PIXELS,
        window: Bbox | None = None,
        opacity: float = 1.0,
        dashed: bool = False,
        join: Join = "miter",
    ) -> None:
        """A path as a line; unit and window as `fill` has them."""
        pen = _pen(window)
        pen.set_linewidth(width_pt)
        pen.set_foreground(to_rgba(colour, opacity), isRGBA=True)
        pen.set_joinstyle(join)
        pen.set_capstyle("butt")
        if dashed:
            pen.set_dashes(0.0, [DASH * width_pt, PAUSE * width_pt])
        path.should_simplify, path.simplify_threshold = _is_long(path), SIMPLER_PX  # whatever a site has set
        self._drawn.append((level, lambda agg: agg.draw_path(pen, path, unit, None)))

    def dots(self, places: ArrayLike, size_pt: float, colour: str, *, level: float = STROKES) -> None:
        """Filled circles around pixels (N, 2)."""
        radius = 0.5 * size_pt * self.pixels_per_point
        points = np.asarray(places, dtype=np.float64).reshape(-1, 2)
        circles = [circle_path(x, y, radius) for x, y in points]
        self.fill(Path.make_compound_path(*circles), colour, level=level)

    def write(
        self,
        x: float,
        y: float,
        words: str,
        *,
        across: Across = "left",
        up: Up = "baseline",
        letters: Letters = PLAIN,
        colour: str = INK,
        upwards: bool = False,
        level: float = WORDS,
        ground: bool = False,
    ) -> None:
        """Words beside a pixel: it is the left, middle or right of them, and their top, middle, bottom or baseline.

        ground: paper shines through behind them, whatever they stand on."""
        if not words:
            return
        paragraph = Paragraph.of(words, letters, self.dpi, upwards=upwards)
        if ground:
            left, bottom, right, top = paragraph.box(x, y, across, up)
            rim = GROUND_RIM_PT * self.pixels_per_point
            self.fill(box_path(left - rim, bottom - rim, right + rim, top + rim), PAPER, level=level, opacity=GROUND_OPACITY)
        pen = _pen(None)
        pen.set_foreground(to_rgba(colour), isRGBA=True)

        def draw(agg: Any) -> None:
            for shape, left, bottom in paragraph.pictures(x, y, across, up):
                agg.draw_text_image(shape, left, self.height_px - bottom, 0.0, pen)

        self._drawn.append((level, draw))

    def png(self) -> bytes:
        """All of it as PNG bytes without any metadata."""
        renderer = RendererAgg(self.width_px, self.height_px, self.dpi)
        ground: NDArray[np.uint8] = np.asarray(renderer.buffer_rgba())
        ground.fill(255)
        for picture, left_px, bottom_px in self._pictures:
            top = len(ground) - bottom_px - len(picture)
            shown = picture[max(0, -top) :, max(0, -left_px) :]
            row, column = max(0, top), max(0, left_px)
            field = ground[row : row + len(shown), column : column + shown.shape[1]]
            field[:] = shown[: field.shape[0], : field.shape[1]]
        for _level, draw in sorted(self._drawn, key=lambda each: each[0]):
            draw(renderer._renderer)
        return encode_png(ground)


def _pen(window: Bbox | None) -> Any:
    pen = GraphicsContextBase()
    pen.set_clip_rectangle(window)
    return pen


def _is_long(path: Path) -> bool:
    """True for straight lines of many corners."""
    codes: Any = path.codes
    return len(np.asarray(path.vertices)) >= LONG and (codes is None or bool((codes <= Path.LINETO).all()))


def box_path(left: float, bottom: float, right: float, top: float) -> Path:
    """A closed rectangle."""
    corners = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
    return Path(corners, closed=True)


def circle_path(x: float, y: float, radius: float) -> Path:
    """A closed circle."""
    return Path.circle((x, y), radius)
