"""Vertices at one place become one; faces without area and faces that are there twice go."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.coincidence import group_equal_faces, position_ids
from core.geometry.degenerate import find_degenerate_faces
from core.geometry.normals import face_crosses
from core.geometry.quality import side_lengths
from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices

Ints = NDArray[np.int64]

ROUNDING_STEPS = 4  # float32 steps of the largest coordinate: a cap this low has its height from rounding
CAP_SIDE = 16  # times that height: a face with a shorter side is a needle


def join_equal_vertices(vertices: Vertices, faces: Faces) -> Staged:
    """Give corners at equal places the same vertex, the lowest; the surface does not move."""
    ids = position_ids(vertices)
    used = np.unique(faces)
    doubled = used[ids[used] != used]
    if len(doubled) == 0:
        return vertices, faces, []
    points = vertices[np.unique(ids[doubled])]
    message = f"{len(doubled)} vertices at the place of another were joined with it, at {len(points)} places"
    return vertices, ids[faces].astype(np.int32), [Change("equal_vertices", message, points, np.zeros(len(points)))]


def drop_flat_faces(vertices: Vertices, faces: Faces) -> Staged:
    """Take away faces without area, exactly or but for the rounding of their coordinates to float32.

    A cap leaves a T-junction on its long side, which the later stage splits.
    """
    flat = np.union1d(find_degenerate_faces(vertices, faces), _find_rounded_caps(vertices, faces))
    if len(flat) == 0:
        return vertices, faces, []
    points = vertices[faces[flat]].mean(axis=1)
    change = Change("degenerate_faces", f"{len(flat)} faces without area were taken away", points, np.zeros(len(flat)))
    return vertices, np.delete(faces, flat, axis=0), [change]


def _find_rounded_caps(vertices: Vertices, faces: Faces) -> Ints:
    """Faces one corner of which lies on the opposite side, give or take `ROUNDING_STEPS`; which way they look is chance."""
    lengths = side_lengths(vertices, faces)
    doubled_area = np.linalg.norm(face_crosses(vertices, faces), axis=1)
    step = np.spacing(np.abs(vertices[faces]).max(axis=(1, 2)).astype(np.float32)).astype(np.float64)
    reach = ROUNDING_STEPS * step
    ordered = np.sort(lengths, axis=1)
    # a needle is no cap: without it, its two ends would have to be joined
    return np.flatnonzero((doubled_area <= reach * ordered[:, 2]) & (ordered[:, 0] > CAP_SIDE * reach))


def drop_doubled_faces(vertices: Vertices, faces: Faces) -> Staged:
    """Keep the first of all faces over the same three corners, whichever way they look."""
    later = np.flatnonzero(group_equal_faces(faces) != np.arange(len(faces)))
    if len(later) == 0:
        return vertices, faces, []
    points = vertices[faces[later]].mean(axis=1)
    change = Change(
        "duplicate_faces", f"{len(later)} faces over the corners of another were taken away", points, np.zeros(len(later))
    )
    return vertices, np.delete(faces, later, axis=0), [change]
