"""Words land where matplotlib's own renderer puts them, and come out of the kept letters as they were."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.font_manager import FontProperties

from core.reports.figures.canvas import _FONT_FILES
from core.reports.figures.lettering import LetteringRenderer, letter

FONT = FontProperties(fname=str(_FONT_FILES["normal"]), size=8.0)


def ink(renderer: RendererAgg, words: str, angle: float) -> np.ndarray:
    """How dark the words make every pixel of a sheet of 200 x 300."""
    graphics = renderer.new_gc()
    graphics.set_foreground("#000000")
    renderer.draw_text(graphics, 120.0, 150.0, words, FONT, angle)
    return np.asarray(renderer.buffer_rgba())[:, :, 3].astype(float)


@pytest.mark.parametrize("angle", [0.0, 90.0])
@pytest.mark.parametrize("words", ["0.2", "share of faces", "−40", "q (1: gp)"])
def test_words_are_where_matplotlib_puts_them(words: str, angle: float) -> None:
    ours, theirs = (ink(kind(300, 200, 150), words, angle) for kind in (LetteringRenderer, RendererAgg))
    assert ours.sum() == pytest.approx(theirs.sum(), rel=0.1)
    for axis in (0, 1):
        middles = [np.average(np.arange(drawn.shape[axis]), weights=drawn.sum(axis=1 - axis)) for drawn in (ours, theirs)]
        assert middles[0] == pytest.approx(middles[1], abs=1.0)


def test_the_same_words_are_laid_out_once_and_drawn_alike() -> None:
    letter.cache_clear()
    first, again = (ink(LetteringRenderer(300, 200, 150), "depth [mm]", 0.0) for _ in range(2))
    assert np.array_equal(first, again)
    assert letter.cache_info().misses == 1
