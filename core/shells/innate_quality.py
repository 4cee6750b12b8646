"""Which faces of a layer are poor: badly shaped, and worse than those of the skin above them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.quality import quality
from core.shells.sheet import Sheet

Floats = NDArray[np.float64]

SHARE = 0.8  # of the skin's q there: what is lower was squeezed on the way
ALWAYS_POOR = 0.15  # q below which a face is poor even if the skin's is no better


def innate_quality(start: Sheet) -> Floats:
    """Lowest q around each skin vertex (V,), as the sheet has it before it moves."""
    shape, around = quality(start.vertices, start.net.faces), start.net.faces_around
    lowest: Floats = np.minimum.reduceat(shape[around.values], around.start[:-1])[start.stand_in]
    return lowest


def find_poor(sheet: Sheet, shape: Floats, below: float, innate: Floats) -> NDArray[np.int64]:
    """Faces with q below `below` and below what is innate there; shape: (F,) q of each face, innate: (V,)."""
    candidates = np.flatnonzero(shape < below)
    own = innate[sheet.origin[sheet.net.faces[candidates]]].min(axis=1)
    found: NDArray[np.int64] = candidates[shape[candidates] < np.maximum(SHARE * own, ALWAYS_POOR)]
    return found
