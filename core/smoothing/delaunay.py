"""Edge flips towards Delaunay where the surface is nearly flat: the re-triangulation of thesis 3.4.2 without its plane."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.normals import face_normals
from core.geometry.quality import quality
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]

FLAT_COSINE = 0.996  # the faces before and after a flip lie within about 5 degrees
OPPOSITE_MARGIN = 1e-6  # of the sine of the two angles' sum, so that four points on a circle do not flip for ever
LEAST_VALENCE = 4  # an end that loses a neighbour keeps at least three


def find_flips(vertices: Vertices, faces: Faces, movable: Flags) -> tuple[Ints, Faces]:
    """Edges to flip at once, no two of them at one face: (faces (K, 2) that change, their new corners (2 K, 3)).

    Flips an edge whose two opposite angles exceed 180° together, if all four corners are `movable` (V,), the other diagonal
    is no edge yet, all four faces lie nearly in one plane, and the lower q does not fall. Largest sum of angles first.
    Source: Lawson 1977; the criterion on surfaces, Bobenko & Springborn 2007, doi:10.1007/s00454-007-9006-1.
    """
    table = edges(faces)
    _edge, pair, side = table.two_faces()
    rows = np.arange(len(pair))
    u = faces[pair[:, 0], side[:, 0]]
    v = faces[pair[:, 0], (side[:, 0] + 1) % 3]
    tip = faces[pair[:, 0], (side[:, 0] + 2) % 3]
    opposite = faces[pair[:, 1], (side[:, 1] + 2) % 3]
    allowed = movable[u] & movable[v] & movable[tip] & movable[opposite]
    excess = _angle_excess(vertices, u, v, tip, opposite)
    rows = rows[allowed & (excess > OPPOSITE_MARGIN)]
    rows = rows[_is_sound(vertices, faces, pair[rows], u[rows], v[rows], tip[rows], opposite[rows])]
    rows = rows[np.argsort(-excess[rows], kind="stable")]

    stride = len(vertices)
    known = table.ends[:, 0] * stride + table.ends[:, 1]  # sorted, as the ends are
    low, high = np.minimum(tip, opposite)[rows].astype(np.int64), np.maximum(tip, opposite)[rows].astype(np.int64)
    place = np.minimum(np.searchsorted(known, low * stride + high), len(known) - 1)
    rows = rows[known[place] != low * stride + high]
    chosen = np.zeros(len(rows), dtype=np.bool_)
    valence = np.bincount(table.ends.ravel(), minlength=len(vertices))
    corners = np.column_stack((u, v, tip, opposite))[rows].astype(np.int64)
    _choose(corners, valence, np.zeros(len(vertices), dtype=np.bool_), chosen)
    a, b, c, d = corners[chosen].T
    changed = np.stack((np.column_stack((a, d, c)), np.column_stack((d, b, c))), axis=1).reshape(-1, 3)
    return pair[rows[chosen]], changed.astype(np.int32)


def _angle_excess(vertices: Vertices, u: Int32s, v: Int32s, tip: Int32s, opposite: Int32s) -> Floats:
    """Minus the sine of the sum of the angles opposite the edge u-v, positive beyond 180°; (N,)."""
    sines, cosines = [], []
    for corner in (tip, opposite):
        a, b = vertices[u] - vertices[corner], vertices[v] - vertices[corner]
        cross = np.cross(a, b)
        length = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
        sines.append(np.linalg.norm(cross, axis=1) / length)
        cosines.append(np.einsum("ij,ij->i", a, b) / length)
    excess: Floats = -(sines[0] * cosines[1] + cosines[0] * sines[1])
    return excess


def _is_sound(vertices: Vertices, faces: Faces, pair: Ints, u: Int32s, v: Int32s, tip: Int32s, opposite: Int32s) -> Flags:
    """Where the two faces and the two in their place look the same way and the lower q of the two does not fall, (N,)."""
    four: list[Faces] = [
        faces[pair[:, 0]],
        faces[pair[:, 1]],
        np.column_stack((u, opposite, tip)),
        np.column_stack((opposite, v, tip)),
    ]
    normals = [face_normals(vertices, some) for some in four]
    cosines = [np.einsum("ij,ij->i", normals[i], normals[j]) for i in range(4) for j in range(i)]
    first, second, third, fourth = (quality(vertices, some) for some in four)
    sound: Flags = (np.minimum.reduce(cosines) > FLAT_COSINE) & (np.minimum(third, fourth) >= np.minimum(first, second))
    return sound


@njit(cache=True, nogil=True)
def _choose(corners: Ints, valence: Ints, touched: Flags, chosen: Flags) -> None:
    """Mark flips that share no corner with one marked before; corners (K, 4): ends, then tips. chosen (K,) holds False."""
    for i in range(len(corners)):
        if min(valence[corners[i, 0]], valence[corners[i, 1]]) < LEAST_VALENCE:
            continue
        free = True
        for k in range(4):
            free = free and not touched[corners[i, k]]
        if free:
            chosen[i] = True
            for k in range(4):
                touched[corners[i, k]] = True
