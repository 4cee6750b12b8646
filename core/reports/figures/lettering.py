"""Words on a sheet: each is laid out and drawn once for all sheets of a process, and put on them as a picture of its letters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.font_manager import FontProperties, get_font
from matplotlib.ft2font import LoadFlags
from numpy.typing import NDArray

MOST_WORDS = 4096  # kept at a time, about 2 kB each
UPWARDS = 90.0  # degrees
UNITS = 64.0  # of FreeType in a pixel


@dataclass(frozen=True, eq=False, slots=True)
class Lettering:
    """shape: coverage of pixels (H, W), row 0 at the top. All lengths in pixels; `left`, `below` are the shape's offsets."""

    shape: NDArray[np.uint8]
    width: float
    height: float
    descent: float
    left: float
    below: float


@lru_cache(maxsize=MOST_WORDS)
def letter(words: str, font_file: str, size_pt: float, dpi: float) -> Lettering:
    """One line of words in the letters of a font file."""
    font: Any = get_font(font_file)
    font.set_size(size_pt, dpi)
    font.set_text(words, 0.0, flags=LoadFlags.DEFAULT)
    font.draw_glyphs_to_bitmap(antialiased=True)
    shape = np.array(font.get_image())
    width, height = font.get_width_height()
    left, below = font.get_bitmap_offset()
    return Lettering(shape, width / UNITS, height / UNITS, font.get_descent() / UNITS, left / UNITS, below / UNITS)


class LetteringRenderer(RendererAgg):  # type: ignore[misc]  # matplotlib is not typed
    """Agg, with the words of `letter`; a text must name the file of its font, and is no formula."""

    def get_text_width_height_descent(self, s: str, prop: FontProperties, ismath: Any) -> tuple[float, float, float]:
        """As matplotlib asks for the size of a line."""
        del ismath
        lettering = letter(s, prop.get_file(), prop.get_size_in_points(), self.dpi)
        return lettering.width, lettering.height, lettering.descent

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: FontProperties, angle: float, ismath: Any = False, mtext: Any = None
    ) -> None:
        """As matplotlib asks for a line whose baseline begins at x, y, downwards from the upper left corner."""
        del ismath, mtext
        lettering = letter(s, prop.get_file(), prop.get_size_in_points(), self.dpi)
        if angle == UPWARDS:  # turned by whole pixels, so that it stays as sharp as what is level
            turned = np.ascontiguousarray(np.rot90(lettering.shape))
            right, bottom = round(x + lettering.descent), round(y - lettering.left)
            self._renderer.draw_text_image(turned, right + 1 - turned.shape[1], bottom, 0.0, gc)
        elif angle == 0.0:
            left, bottom = round(x + lettering.left), round(y + lettering.below + lettering.descent)
            self._renderer.draw_text_image(lettering.shape, left, bottom + 1, 0.0, gc)
        else:
            raise ValueError(f"words run level or upwards, not at {angle}°")
