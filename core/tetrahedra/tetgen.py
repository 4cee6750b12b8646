"""TetGen, told by points which space is which."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import tetgen
from numpy.typing import NDArray

from core.tetrahedra.forked import Filling, run_forked


@dataclass(frozen=True, eq=False, slots=True)
class Facets:
    """What TetGen is given.

    vertices: (V, 3) mm; faces: (F, 3). points: (N, 3), one in each space to fill; region: (N,) its number, above 0;
    largest: (N,) largest tetrahedron in mm³, 0 for any.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    points: NDArray[np.float64]
    region: NDArray[np.int64]
    largest: NDArray[np.float64]


def run_tetgen(facets: Facets, switches: str) -> Filling:
    """Raises: InputError `tetrahedra.refused` with what TetGen said, also if its process crashed."""
    return run_forked("TetGen", lambda: _fill(facets, switches))


def _fill(facets: Facets, switches: str) -> Filling:
    filler = tetgen.TetGen(facets.vertices, facets.faces)
    for number, point, largest in zip(facets.region, facets.points, facets.largest, strict=True):
        filler.add_region(int(number), tuple(point.tolist()), float(largest))
    nodes, tetrahedra, region, *_ = filler.tetrahedralize(switches=switches)
    return Filling(nodes, tetrahedra, np.rint(region).astype(np.int32).ravel())
