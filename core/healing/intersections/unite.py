"""Parts of a surface that run into each other become one: the border of the space that they hold together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.coincidence import position_ids
from core.geometry.components import face_components
from core.geometry.normals import face_areas
from core.healing.intersections.arrangement import Arrangement
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

SHRED_SHARE = 1e-3  # of the largest piece's area: smaller pieces that a cut left over are dropped


def unite(vertices: Vertices, faces: Faces, arrangement: Arrangement) -> tuple[Vertices, Faces, Flags, Ints]:
    """The border of all space inside of the surface: new vertices, faces (G, 3), which of these are parts of cut faces (G,),
    and the face each is part of (G,).

    Faces that nothing cuts keep their corners bit for bit and come first, in their order; vertices keep their numbers and
    new ones follow, on coordinates of float32, in the order of their places.
    """
    points, parts, birth = arrangement.union()
    whole = np.bincount(birth, minlength=len(faces))[birth] == 1
    corner = _numbers_at(points, vertices)
    whole &= (np.sort(corner[parts], axis=1) == np.sort(position_ids(vertices)[faces[birth]], axis=1)).all(axis=1)
    kept = np.sort(birth[whole])
    cut = parts[~whole]
    new = np.unique(cut[corner[cut] < 0])
    rounded = points[new].astype(np.float32).astype(np.float64)
    by_place = np.lexsort(rounded.T[::-1])
    corner[new[by_place]] = len(vertices) + np.arange(len(new))
    every = np.concatenate((vertices, rounded[by_place]))
    added = corner[cut]
    first = added.argmin(axis=1)
    added = np.take_along_axis(added, (first[:, None] + np.arange(3)) % 3, axis=1)
    order = np.lexsort(added.T[::-1])
    joined = np.concatenate((faces[kept], added[order])).astype(np.int32)
    origin = np.concatenate((kept, birth[~whole][order]))
    is_new = np.arange(len(joined)) >= len(kept)
    stays = ~_shreds(every, joined, is_new)
    return every, joined[stays], is_new[stays], origin[stays]


def _numbers_at(points: Vertices, vertices: Vertices) -> Ints:
    """For each of points (W, 3) the vertex at its place, the first of several, or -1."""
    ids = position_ids(np.concatenate((vertices, points)))[len(vertices) :]
    return np.where(ids < len(vertices), ids, -1)


def _shreds(vertices: Vertices, faces: Faces, is_new: Flags) -> Flags:
    """Faces of tiny pieces that consist of cut faces alone, (G,)."""
    count, piece = face_components(edges(faces))
    area = np.bincount(piece, weights=face_areas(vertices, faces), minlength=count)
    old = np.bincount(piece[~is_new], minlength=count)
    shred: Flags = ((old == 0) & (area < SHRED_SHARE * area.max()))[piece]
    return shred
