"""Matplotlib without its global state: same calls, same PNG bytes, whatever the machine's fonts and settings are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text
from numpy.typing import NDArray

from core.reports.figures.lettering import LetteringRenderer
from core.reports.figures.png import encode_png

DPI = 150
INK = "#22262b"
FAINT = "#8a9099"
PAPER = "#ffffff"

_FONT_FOLDER = Path(matplotlib.get_data_path(), "fonts", "ttf")
_FONT_FILES = {"normal": _FONT_FOLDER / "DejaVuSans.ttf", "bold": _FONT_FOLDER / "DejaVuSans-Bold.ttf"}
_STYLE: dict[str, Any] = {
    "font.size": 8.0,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "text.color": INK,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "image.interpolation": "nearest",
}
# a site's matplotlibrc must not change a report; backend and interactive mode are global and not touched
_GLOBAL = {"backend", "interactive", "toolbar"}
_SETTINGS = {key: value for key, value in matplotlib.rcParamsDefault.items() if key not in _GLOBAL} | _STYLE


class PaintedCanvas(FigureCanvasAgg):  # type: ignore[misc]  # matplotlib is not typed
    """Agg over ready-made pictures: they are the ground that all else is drawn on, pixel for pixel."""

    def __init__(self, figure: Sheet) -> None:
        super().__init__(figure)
        self._pictures: list[tuple[NDArray[np.uint8], int, int]] = []

    def place(self, picture: NDArray[np.uint8], left_px: int, bottom_px: int) -> None:
        """A picture (H, W, 3), row 0 at the top; what lies beyond the sheet is not shown."""
        self._pictures.append((picture, left_px, bottom_px))

    def drawn(self) -> NDArray[np.uint8]:
        """The finished sheet, (H, W, 4)."""
        width, height = self.get_width_height()
        renderer = LetteringRenderer(width, height, self.figure.dpi)
        ground: NDArray[np.uint8] = np.asarray(renderer.buffer_rgba())
        ground[:] = 255
        for picture, left_px, bottom_px in self._pictures:
            top = len(ground) - bottom_px - len(picture)
            shown = picture[max(0, -top) :, max(0, -left_px) :]
            row, column = max(0, top), max(0, left_px)
            field = ground[row : row + len(shown), column : column + shown.shape[1], :3]
            field[:] = shown[: field.shape[0], : field.shape[1]]
        self.figure.patch.set_visible(False)  # it would cover the ground
        self.figure.draw(renderer)
        return ground


def place_pixels(figure: Sheet, picture: NDArray[np.uint8], left_px: int, bottom_px: int) -> None:
    """As `PaintedCanvas.place` on the canvas of a sheet."""
    canvas = figure.canvas
    if not isinstance(canvas, PaintedCanvas):
        raise TypeError(f"a sheet draws on a PaintedCanvas, not on a {type(canvas).__name__}")
    canvas.place(picture, left_px, bottom_px)


@contextmanager
def sheet(width_in: float, height_in: float, dpi: int = DPI) -> Iterator[Sheet]:
    """An empty figure of that size in inches; everything on it must be drawn, and `to_png` called, inside the block."""
    present = matplotlib.rcParams
    # setting all 300 takes longer than drawing a small figure, and they rarely differ
    with matplotlib.rc_context({key: value for key, value in _SETTINGS.items() if present[key] != value}):
        figure = Sheet(figsize=(width_in, height_in), dpi=dpi, facecolor=PAPER)
        PaintedCanvas(figure)
        yield figure


def to_png(figure: Sheet) -> bytes:
    """The drawing as PNG bytes without any metadata."""
    for text in _all_texts(figure):
        weight = "bold" if text.get_fontweight() in {"bold", 700} else "normal"
        # by file: a system font of the same family may have other glyphs
        text.set_fontproperties(FontProperties(fname=str(_FONT_FILES[weight]), size=text.get_fontsize()))
        text.set_parse_math(False)  # names come from users; `$` is a letter
    canvas = figure.canvas
    if not isinstance(canvas, PaintedCanvas):
        raise TypeError(f"a sheet draws on a PaintedCanvas, not on a {type(canvas).__name__}")
    return encode_png(canvas.drawn())


def _all_texts(figure: Sheet) -> list[Any]:
    for axes in figure.axes:
        # ticks are made on demand: ask, so that their labels exist
        for axis in (axes.xaxis, axes.yaxis):
            axis.get_majorticklabels()
    return list(figure.findobj(Text))
