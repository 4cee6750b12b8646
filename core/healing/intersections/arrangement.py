"""A closed surface cut along its intersections, and how often it winds around the space on either side of each part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from igl.copyleft.cgal import extract_cells, remesh_self_intersections
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from core.mesh import Faces, Vertices

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Arrangement:
    """Parts of faces that meet only in corners and edges.

    vertices: (W, 3) mm; those of the surface first, as they were. faces: (G, 3). birth: (G,) the face each is part of.
    outside: (G,) winding number of the space that the face looks into; behind it is one more. -1 or less: the surface is
    turned inside out there; 1 or more: it lies inside of another part.
    """

    vertices: Vertices
    faces: Ints
    birth: Ints
    outside: Ints

    @classmethod
    def of(cls, vertices: Vertices, faces: Faces) -> Arrangement:
        """Needs a closed and consistently oriented surface without faces of zero area. Exact but for the rounding of new places.

        Source: Zhou, Grinspun, Zorin, Jacobson 2016, doi:10.1145/2897824.2925901 (libigl's cells over CGAL)."""
        points, parts, _pairs, birth, _same = remesh_self_intersections(
            np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(faces, dtype=np.int64), stitch_all=True
        )
        _count, beside = extract_cells(points, parts)
        outside = _winding_numbers(beside)[beside[:, 0]]
        return cls(points, parts.astype(np.int64), birth.astype(np.int64).ravel(), outside)

    def union(self) -> tuple[Vertices, Ints, Ints]:
        """The border of all space that is wound around at least once: vertices (W, 3), faces (G, 3) and births (G,)."""
        border = self.outside == 0
        return self.vertices, self.faces[border], self.birth[border]


def _winding_numbers(beside: Ints) -> Ints:
    """Of each cell, given the cells (G, 2) before and behind each face; cell 0 is the far outside, with number 0."""
    count = int(beside.max(initial=0)) + 1
    number = np.zeros(count, dtype=np.int64)
    one_way = coo_array((np.ones(len(beside)), (beside[:, 0], beside[:, 1])), shape=(count, count)).tocsr()
    order, parent = breadth_first_order(one_way + one_way.T, 0, directed=False)
    inwards = {(int(before), int(behind)) for before, behind in np.unique(beside, axis=0)}
    for cell in order[1:].tolist():
        before = int(parent[cell])
        number[cell] = number[before] + (1 if (before, cell) in inwards else -1)
    return number
