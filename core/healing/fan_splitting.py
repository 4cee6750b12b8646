"""Vertices where several fans of faces meet: each fan gets a vertex of its own, a little apart from the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_crosses
from core.healing.change import Change, Staged
from core.healing.local_crossings import find_crossings_of
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PULL = 0.02  # of the mean distance to the neighbours: how far a fan is drawn from the place it shared
FLAT = 0.2  # of that distance: a fan whose neighbours' middle is nearer is flat and is drawn along its normal


def split_fans(vertices: Vertices, faces: Faces, fan: Ints, kind: str, what: str, only: Ints | None = None) -> Staged:
    """Give every fan but the first and largest of each vertex a new vertex; only: vertices to treat (K,), default all.

    fan: (F, 3) number of the fan at each corner. The new vertex lies `PULL` into its own fan, or along the normal of a
    flat one; of these the first place where its faces meet nothing else.
    """
    numbers, sizes = np.unique(fan, return_counts=True)
    vertex_of = np.zeros(int(numbers.max()) + 1, dtype=np.int64)
    vertex_of[fan.ravel()] = faces.ravel()
    owner = vertex_of[numbers]
    order = np.lexsort((numbers, -sizes, owner))
    later = np.append(False, owner[order][1:] == owner[order][:-1])
    moving = numbers[order[later]]
    if only is not None:
        moving = moving[np.isin(vertex_of[moving], only)]
    if len(moving) == 0:
        return vertices, faces, []
    moving = np.sort(moving)
    number = np.full(len(vertex_of), -1, dtype=np.int64)
    number[moving] = len(vertices) + np.arange(len(moving))
    split = np.where(number[fan] >= 0, number[fan], faces).astype(np.int32)
    places = _place(vertices, split, vertex_of[moving])
    shared = vertices[vertex_of[moving]]
    distances = np.linalg.norm(places - shared, axis=1)
    message = f"{len(moving)} {what}, up to {distances.max():.3g} mm apart"
    return np.concatenate((vertices, places)), split, [Change(kind, message, shared, distances)]


def _place(vertices: Vertices, faces: Faces, shared: Ints) -> Floats:
    """Places of the new vertices, which follow the old ones and stand for `shared` (N,)."""
    count = len(vertices)
    at = vertices[shared]
    candidates = _candidates(np.concatenate((vertices, at)), faces, count)
    stars = np.flatnonzero((faces >= count).any(axis=1))
    choice = np.zeros(len(shared), dtype=np.int64)
    for last in range(1, len(candidates)):
        places = candidates[choice, np.arange(len(shared))]
        pairs = find_crossings_of(np.concatenate((vertices, places)), faces, stars)
        guilty = np.unique(faces[pairs])
        guilty = guilty[guilty >= count] - count
        if len(guilty) == 0:
            break
        choice[guilty] = np.minimum(choice[guilty] + 1, last)
    chosen: Floats = candidates[choice, np.arange(len(shared))]
    return chosen


def _candidates(vertices: Floats, faces: Faces, count: int) -> Floats:
    """Places for each new vertex (from number `count` on): into its fan, against its normal, along it; (3, N, 3) mm."""
    corners = faces.ravel().astype(np.int64)
    new = corners >= count
    row = np.flatnonzero(new) // 3
    which = corners[new] - count
    size = len(vertices) - count
    middle, normal = np.zeros((size, 3)), np.zeros((size, 3))
    spokes, faces_at = np.zeros(size), np.bincount(which, minlength=size)
    crosses = face_crosses(vertices, faces[row])
    for turn in (1, 2):
        other = faces[row, (np.flatnonzero(new) % 3 + turn) % 3]
        offset = vertices[other] - vertices[corners[new]]
        np.add.at(middle, which, offset)
        np.add.at(spokes, which, np.linalg.norm(offset, axis=1))
    np.add.at(normal, which, crosses)
    middle /= 2 * faces_at[:, None]
    spokes /= 2 * faces_at
    length = np.linalg.norm(normal, axis=1)
    normal = np.divide(normal, length[:, None], out=np.zeros_like(normal), where=length[:, None] > 0.0) * spokes[:, None]
    flat = np.linalg.norm(middle, axis=1) < FLAT * spokes
    middle[flat] = -normal[flat]
    places = vertices[count:] + PULL * np.stack((middle, -normal, normal))
    rounded: Floats = places.astype(np.float32).astype(np.float64)
    return rounded
