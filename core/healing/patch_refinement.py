"""Patches over holes get faces as large as those around them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.normals import corner_angles, face_crosses
from core.mesh import Faces

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DENSITY = np.sqrt(2.0)  # a face gets a vertex in its middle if this times the way to its corners exceeds the edges there
ROUNDS = 24  # each multiplies the faces by up to three
SWEEPS = 60
SMALLEST_GAIN = 1e-6  # radians, so that equal pairs of angles are not flipped back and forth
LARGEST_TURN = 0.7  # cosine: a flipped pair may not look elsewhere than the pair before


def refine(points: Floats, faces: Faces, patch: Ints, size: Floats, taken: Ints) -> tuple[Floats, Faces, Ints, Floats]:
    """Insert middles of faces that are too large and flip edges to Delaunay's, in all patches at once.

    points: (P, 3) mm. faces: (F, 3) of all patches. patch: (F,) the patch of each. size: (P,) mm, length of edges around each
    point. taken: (K, 2) edges outside the patches between their points. Sides of patches stay.
    Returns points, the old ones first, faces, patch and size. Source: Liepa 2003, section 4.
    """
    faces = flip_to_delaunay(points, faces, taken)
    for _ in range(ROUNDS):
        corners = points[faces]
        middle = corners.mean(axis=1)
        wanted = size[faces].mean(axis=1)
        way = np.linalg.norm(corners - middle[:, None], axis=2)
        large = (DENSITY * way > np.maximum(wanted[:, None], size[faces])).all(axis=1)
        if not large.any():
            break
        new = len(points) + np.arange(int(large.sum()), dtype=np.int32)
        a, b, c = faces[large].T
        parts = [np.column_stack(three) for three in ((a, b, new), (b, c, new), (c, a, new))]
        faces = np.concatenate((faces[~large], *parts))
        patch = np.concatenate((patch[~large], *([patch[large]] * 3)))
        points, size = np.concatenate((points, middle[large])), np.concatenate((size, wanted[large]))
        faces = flip_to_delaunay(points, faces, taken)
    return points, faces, patch, size


def flip_to_delaunay(points: Floats, faces: Faces, taken: Ints) -> Faces:
    """Flip inner edges whose opposite angles exceed 180° together; as many at once as touch no face twice."""
    faces = faces.copy()
    stride = len(points)
    outside = _keys(taken[:, 0], taken[:, 1], stride)
    for _ in range(SWEEPS):
        found = edges(faces)
        _edge, pair, side = found.two_faces()
        if len(pair) == 0:
            break
        angles = corner_angles(points, faces)
        opposite = [angles[pair[:, i], (side[:, i] + 2) % 3] for i in range(2)]
        gain = opposite[0] + opposite[1] - np.pi
        asked = np.flatnonzero(gain > SMALLEST_GAIN)
        a, b = faces[pair[asked, 0], side[asked, 0]], faces[pair[asked, 0], (side[asked, 0] + 1) % 3]
        c, d = faces[pair[asked, 0], (side[asked, 0] + 2) % 3], faces[pair[asked, 1], (side[asked, 1] + 2) % 3]
        first, second = np.column_stack((c, a, d)), np.column_stack((d, b, c))
        key = _keys(c, d, stride)
        present = np.concatenate((outside, _keys(found.ends[:, 0], found.ends[:, 1], stride)))
        fits = (c != d) & ~np.isin(key, present) & _keeps_looking(points, faces, pair[asked], first, second)
        asked, first, second, key = asked[fits], first[fits], second[fits], key[fits]
        chosen = _independent(gain[asked], pair[asked], key, len(faces))
        if len(chosen) == 0:
            break
        faces[pair[asked[chosen], 0]], faces[pair[asked[chosen], 1]] = first[chosen], second[chosen]
    return faces


def _keys(a: NDArray[np.integer], b: NDArray[np.integer], stride: int) -> Ints:
    keys: Ints = np.minimum(a, b).astype(np.int64) * stride + np.maximum(a, b)
    return keys


def _keeps_looking(points: Floats, faces: Faces, pair: Ints, first: Faces, second: Faces) -> NDArray[np.bool_]:
    """True where both new faces look roughly where the old two did."""
    old = face_crosses(points, faces[pair[:, 0]]) + face_crosses(points, faces[pair[:, 1]])
    size = np.linalg.norm(old, axis=1)
    fits = np.ones(len(pair), dtype=np.bool_)
    for new in (first, second):
        cross = face_crosses(points, new)
        fits &= np.einsum("ij,ij->i", cross, old) > LARGEST_TURN * size * np.linalg.norm(cross, axis=1)
    return fits


def _independent(gain: Floats, pair: Ints, key: Ints, face_count: int) -> Ints:
    """Flips that are the best of both their faces, none of which makes the edge of another."""
    order = np.lexsort((np.arange(len(gain)), -gain))
    rank = np.empty(len(gain), dtype=np.int64)
    rank[order] = np.arange(len(gain))
    best = np.full(face_count, len(gain), dtype=np.int64)
    for i in range(2):
        np.minimum.at(best, pair[:, i], rank)
    chosen = np.flatnonzero((best[pair[:, 0]] == rank) & (best[pair[:, 1]] == rank))
    chosen = chosen[np.argsort(rank[chosen])]
    return chosen[np.sort(np.unique(key[chosen], return_index=True)[1])]
