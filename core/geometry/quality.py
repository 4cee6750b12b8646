"""Triangle quality q (thesis 2.4.1) and edge lengths."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_crosses
from core.mesh import Faces, Vertices


def side_lengths(vertices: Vertices, faces: Faces) -> NDArray[np.float64]:
    """Lengths in mm, (F, 3); side i lies opposite corner i."""
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    lengths: NDArray[np.float64] = np.sqrt(np.einsum("fij,fij->fi", sides, sides))
    return lengths


def quality(vertices: Vertices, faces: Faces) -> NDArray[np.float64]:
    """q = 2 r_in / r_out per face, (F,): 1 for an equilateral triangle, 0 for one without area.

    The thesis writes (b+c-a)(c+a-b)(a+b-c)/(abc). The equal form 16 A² / (abc (a+b+c)) is used: it does not lose the
    digits of a needle, whose longest side nearly equals the sum of the others.
    """
    crosses = face_crosses(vertices, faces)
    sides = side_lengths(vertices, faces)
    product = sides.prod(axis=1) * sides.sum(axis=1)
    sixteen_areas_squared = 4.0 * np.einsum("ij,ij->i", crosses, crosses)
    q: NDArray[np.float64] = np.divide(sixteen_areas_squared, product, out=np.zeros(len(faces)), where=product > 0.0)
    return np.minimum(q, 1.0)  # rounding may lift an equilateral triangle one bit above
