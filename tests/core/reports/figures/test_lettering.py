"""Words are what matplotlib's own renderer draws, and come out of the kept letters as they were."""

from __future__ import annotations

import io

import numpy as np
import pytest
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from PIL import Image

from core.reports.figures.canvas import Sheet
from core.reports.figures.lettering import _FILES, Letters, letter

LETTERS = Letters(8.0)


def ours(words: str, *, upwards: bool) -> np.ndarray:
    """How dark the words make every pixel of a sheet of 300 x 200."""
    sheet = Sheet(2.0, 200 / 150)
    sheet.write(120.0, 100.0, words, across="right", up="center", letters=LETTERS, colour="#000000", upwards=upwards)
    return 255.0 - np.asarray(Image.open(io.BytesIO(sheet.png())).convert("L"), dtype=float)


def theirs(words: str, *, upwards: bool) -> np.ndarray:
    figure = Figure(figsize=(2.0, 200 / 150), dpi=150)
    font = FontProperties(fname=_FILES["normal"], size=8.0)
    style = {"ha": "right", "va": "center", "rotation": 90 if upwards else 0, "fontproperties": font}
    text = figure.text(120.0 / 300, 100.0 / 200, words, parse_math=False, **style)
    renderer = RendererAgg(300, 200, 150)
    text.draw(renderer)
    return np.asarray(renderer.buffer_rgba())[:, :, 3].astype(float)


@pytest.mark.parametrize("upwards", [False, True])
@pytest.mark.parametrize("words", ["0.2", "share of faces", "−40", "q (1: gp)", "two\nlines"])
def test_words_are_where_matplotlib_puts_them(words: str, upwards: bool) -> None:
    own, other = ours(words, upwards=upwards), theirs(words, upwards=upwards)
    assert own.sum() == pytest.approx(other.sum(), rel=0.1)
    for axis in (0, 1):
        middles = [np.average(np.arange(drawn.shape[axis]), weights=drawn.sum(axis=1 - axis)) for drawn in (own, other)]
        assert middles[0] == pytest.approx(middles[1], abs=1.0)


def test_the_same_words_are_laid_out_once_and_drawn_alike() -> None:
    letter.cache_clear()
    first, again = (ours("depth [mm]", upwards=False) for _ in range(2))
    assert np.array_equal(first, again)
    assert letter.cache_info().misses == 1
