"""How many faces a report can show and still be sent by mail."""

from __future__ import annotations

from collections.abc import Sequence

from core.reports.figures.figure import Figure
from core.reports.scene.scene import MOST_FACES

MOST_BYTES = 8_000_000  # of the file
PAGE_BYTES = 900_000  # of them the viewer, words and tables
BASE64 = 4 / 3
BYTES_PER_FACE = 3.3  # of coarse and of thinned surfaces with depths; fine ones take 2.3, and 0.5 for depths
LEAST_FACES = 100_000  # with fewer a body could not be recognized: then the file is larger


def mailable_faces(figures: Sequence[Figure]) -> int:
    """Of all surfaces together, beside these figures: the more of them, the coarser the view, never more than MOST_FACES."""
    room = (MOST_BYTES - PAGE_BYTES) / BASE64 - sum(len(figure.png) for figure in figures)
    return min(max(int(room / BYTES_PER_FACE), LEAST_FACES), MOST_FACES)
