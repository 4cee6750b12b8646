"""Which tissue every tetrahedron belongs to: what the surfaces part, and nothing else, is different."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.components import label_connected
from core.tetrahedra.element_quality import volumes
from core.tetrahedra.sides import NONE, face_keys, sides


def spread_regions(
    vertices: NDArray[np.float64], tetrahedra: NDArray[np.int32], region: NDArray[np.int32], faces: NDArray[np.int32]
) -> NDArray[np.int32]:
    """The region (T,) of each tetrahedron, the same in every space that the faces (F, 3) of the surfaces enclose.

    A space gets the number that most of its volume has: TetGen's refinement leaves single tetrahedra with that of a neighbour.
    """
    all_sides = sides(tetrahedra)
    parted = np.isin(face_keys(all_sides.corners), face_keys(np.sort(faces.astype(np.int64), axis=1)))
    joined = ~parted & (all_sides.second != NONE)
    count, space = label_connected(len(tetrahedra), all_sides.first[joined], all_sides.second[joined])
    numbers, which = np.unique(region, return_inverse=True)
    size = np.bincount(space * len(numbers) + which, weights=volumes(vertices[tetrahedra]), minlength=count * len(numbers))
    spread: NDArray[np.int32] = numbers[size.reshape(count, len(numbers)).argmax(axis=1)][space].astype(np.int32)
    return spread
