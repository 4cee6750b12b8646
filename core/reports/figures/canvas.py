"""Matplotlib without its global state: same calls, same PNG bytes, whatever the machine's fonts and settings are."""

from __future__ import annotations

import io
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
from PIL import Image

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


@contextmanager
def sheet(width_in: float, height_in: float, dpi: int = DPI) -> Iterator[Sheet]:
    """An empty figure of that size in inches; everything on it must be drawn, and `to_png` called, inside the block."""
    with matplotlib.rc_context(_SETTINGS):
        figure = Sheet(figsize=(width_in, height_in), dpi=dpi, facecolor=PAPER)
        FigureCanvasAgg(figure)
        yield figure


def to_png(figure: Sheet) -> bytes:
    """The drawing as PNG bytes without any metadata."""
    for text in _all_texts(figure):
        weight = "bold" if text.get_fontweight() in {"bold", 700} else "normal"
        # by file: a system font of the same family may have other glyphs
        text.set_fontproperties(FontProperties(fname=str(_FONT_FILES[weight]), size=text.get_fontsize()))
        text.set_parse_math(False)  # names come from users; `$` is a letter
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        raise TypeError(f"a sheet draws with Agg, not {type(canvas).__name__}")
    canvas.draw()
    image = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    out = io.BytesIO()
    image.save(out, format="PNG")
    return out.getvalue()


def _all_texts(figure: Sheet) -> list[Any]:
    for axes in figure.axes:
        # ticks are made on demand: ask, so that their labels exist
        for axis in (axes.xaxis, axes.yaxis):
            axis.get_majorticklabels()
    return list(figure.findobj(Text))
