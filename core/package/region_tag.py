"""Numbers of tissues in gmsh, SimNIBS, NASTRAN and TetGen files."""

from __future__ import annotations

from collections.abc import Sequence

from core.package.conductivity import tissue_word
from core.package.tissue import Tissue

SURFACE = 1000  # SimNIBS numbers the surface of tissue n as 1000 + n
FIRST_OTHER = 101  # SimNIBS leaves numbers above 100 to its users
_SIMNIBS = {
    "whitematter": 1,
    "greymatter": 2,
    "csf": 3,
    "bone": 4,
    "skin": 5,
    "muscle": 10,
    "averagebody": 10,
    "cartilage": 11,
    "fat": 12,
}


def region_tags(tissues: Sequence[Tissue]) -> dict[str, int]:
    """Tissue name -> number of its volume: that of SimNIBS if it knows the tissue, else 101, 102, … No number comes twice."""
    tags: dict[str, int] = {}
    others = iter(range(FIRST_OTHER, FIRST_OTHER + len(tissues)))
    for tissue in tissues:
        known = _SIMNIBS.get(tissue_word(tissue.name))
        tags[tissue.name] = known if known is not None and known not in tags.values() else next(others)
    return tags
