"""Words as pictures of their letters: each is laid out and drawn once for all sheets of a process."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.font_manager import get_font
from matplotlib.ft2font import LoadFlags
from numpy.typing import NDArray

Weight = Literal["normal", "bold"]
MOST_WORDS = 4096  # kept at a time, about 2 kB each
UNITS = 64.0  # of FreeType in a pixel
POINTS_PER_INCH = 72.0

_FOLDER = Path(matplotlib.get_data_path(), "fonts", "ttf")  # by file: a system's font of the same family may have other glyphs
_FILES: dict[Weight, str] = {"normal": str(_FOLDER / "DejaVuSans.ttf"), "bold": str(_FOLDER / "DejaVuSans-Bold.ttf")}


@dataclass(frozen=True, slots=True)
class Letters:
    """What words are set in; the size in pixels follows from the sheet."""

    size_pt: float = 8.0
    weight: Weight = "normal"


@dataclass(frozen=True, eq=False, slots=True)
class Lettering:
    """One line. shape: coverage of pixels (H, W), row 0 at the top; `left`, `below` are its offsets. All lengths in pixels.

    ascent, descent: above and below the baseline, those of the font at least. gap: between lines."""

    shape: NDArray[np.uint8]
    width: float
    ink_descent: float
    left: float
    below: float
    ascent: float
    descent: float
    gap: float


@lru_cache(maxsize=MOST_WORDS)
def letter(words: str, letters: Letters, dpi: float) -> Lettering:
    """One line of words for a sheet of so many dots per inch."""
    font: Any = get_font(_FILES[letters.weight])
    font.set_size(letters.size_pt, dpi)
    font.set_text(words, 0.0, flags=LoadFlags.DEFAULT)
    font.draw_glyphs_to_bitmap(antialiased=True)
    shape = np.array(font.get_image())
    width, height = (length / UNITS for length in font.get_width_height())
    left, below = (length / UNITS for length in font.get_bitmap_offset())
    ink_descent = font.get_descent() / UNITS
    ascent, descent, gap = _metrics(letters, dpi)
    return Lettering(shape, width, ink_descent, left, below, max(ascent, height - ink_descent), max(descent, ink_descent), gap)


@lru_cache
def _metrics(letters: Letters, dpi: float) -> tuple[float, float, float]:
    """Ascent, descent and gap between lines of a font, in pixels."""
    font: Any = get_font(_FILES[letters.weight])
    scale = letters.size_pt * dpi / POINTS_PER_INCH / font.get_sfnt_table("head")["unitsPerEm"]
    table = font.get_sfnt_table("OS/2")
    return table["sTypoAscender"] * scale, -table["sTypoDescender"] * scale, table["sTypoLineGap"] * scale
