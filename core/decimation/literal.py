"""The thesis' script (Appendix A) step for step: no guards, so it may break the surface. For comparison."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.decimation.thinned import Thinned
from core.mesh import Mesh, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


def collapse_literally(mesh: Mesh, goal: int, smooth_weight: float) -> Thinned:
    """Run the script until at most `goal` faces are left, or none that may be chosen.

    As written there: the mean angle counts the face itself as its neighbour, angles are those of `subspace` (0 to 90
    degrees), equal values leave the choice to the lower face number, vertex 1 of the shortest side becomes vertex 2.
    `find_att_nodes` and `meshlaplace3` are not printed: taken as all vertices of the faces around, and as moving all
    vertices at once by `smooth_weight` of the way to the mean of their neighbours.
    Only what a collapse changes is computed anew, so a collapse takes O(log F) instead of O(F²).
    """
    points, faces = mesh.vertices.copy(), mesh.faces.astype(np.int64)
    present = np.ones(len(faces), dtype=np.bool_)
    taker = np.arange(len(points))
    collapses = _run(points, faces, present, taker, goal, smooth_weight)
    kept = faces[present]
    used, corner = np.unique(kept, return_inverse=True)
    while not np.array_equal(taker, taker[taker]):
        taker = taker[taker]
    rank = np.full(len(points), -1, dtype=np.int64)
    rank[used] = np.arange(len(used))
    return Thinned(Mesh.of(points[used], corner.reshape(-1, 3)).rounded_to_float32(), rank[taker], {"done": int(collapses)})


@njit(cache=True, nogil=True)
def _run(points: Vertices, faces: Ints, present: Flags, taker: Ints, goal: int, weight: float) -> int:
    """Edit points (V, 3), faces (F, 3), present (F,) and taker (V,) in place; returns the number of collapses."""
    total, count = len(faces), len(points)
    # faces around each vertex: chains of corners, joined when vertices are
    chain, head, tail = np.full(3 * total, -1, np.int64), np.full(count, -1, np.int64), np.full(count, -1, np.int64)
    for corner in range(3 * total):
        vertex = faces[corner // 3, corner % 3]
        if head[vertex] < 0:
            head[vertex] = corner
        else:
            chain[tail[vertex]] = corner
        tail[vertex] = corner
    normals = np.empty((total, 3))
    for face in range(total):
        _set_normal(points, faces, face, normals)
    # the lowest value of each pair of a complete tree; leaf of face f: width - 1 + f
    width = 1
    while width < total:
        width *= 2
    lowest = np.full(2 * width - 1, np.inf)
    stamp, face_stamp, token = np.full(count, -1, np.int64), np.full(total, -1, np.int64), 0
    for face in range(total):
        token += 1
        lowest[width - 1 + face] = _mean_angle(faces, present, chain, head, normals, face, face_stamp, token)
    for node in range(width - 2, -1, -1):
        lowest[node] = min(lowest[2 * node + 1], lowest[2 * node + 2])

    near, moved, ring = np.empty(count, np.int64), np.empty((count, 3)), np.full(count, -1, np.int64)
    asked = np.full(total, -1, np.int64)
    ring_token, collapses, left = 0, 0, total
    while left > goal and lowest[0] < np.inf:
        node = 0
        while node < width - 1:
            node = 2 * node + 1 if lowest[2 * node + 1] <= lowest[2 * node + 2] else 2 * node + 2
        face = node - width + 1
        start, end = _shortest_side(points, faces, face)
        # vertex 1 becomes vertex 2
        corner = head[start]
        while corner >= 0:
            faces[corner // 3, corner % 3] = end
            corner = chain[corner]
        chain[tail[end]] = head[start]
        tail[end] = tail[start]
        head[start] = -1
        taker[start] = end
        # two rings of vertices, before faces are deleted
        token += 1
        size = _add_ring(faces, present, chain, head, end, stamp, token, near, 0)
        for i in range(size):
            size = _add_ring(faces, present, chain, head, near[i], stamp, token, near, size)
        corner = head[end]
        while corner >= 0:
            f = corner // 3
            if present[f] and (faces[f, 0] == faces[f, 1] or faces[f, 1] == faces[f, 2] or faces[f, 2] == faces[f, 0]):
                present[f] = False
                left -= 1
                _set_lowest(lowest, width - 1 + f, np.inf)
            corner = chain[corner]
        # all at once: new places from old ones
        for i in range(size):
            ring_token += 1
            _place(points, faces, present, chain, head, near[i], weight, ring, ring_token, moved[i])
        for i in range(size):
            for axis in range(3):
                points[near[i], axis] = moved[i, axis]
        _renew(points, faces, present, chain, head, normals, near[:size], lowest, width, face_stamp, asked, collapses, token)
        token += total + 1
        collapses += 1
    return collapses


@njit(cache=True, nogil=True)
def _renew(
    points: Vertices,
    faces: Ints,
    present: Flags,
    chain: Ints,
    head: Ints,
    normals: Floats,
    moved: Ints,
    lowest: Floats,
    width: int,
    face_stamp: Ints,
    asked: Ints,
    turn: int,
    token: int,
) -> None:
    """Normals of the faces around moved vertices, then the angles of these and of all faces that touch them."""
    for vertex in moved:
        corner = head[vertex]
        while corner >= 0:
            if present[corner // 3]:
                _set_normal(points, faces, corner // 3, normals)
            corner = chain[corner]
    for vertex in moved:
        corner = head[vertex]
        while corner >= 0:
            f = corner // 3
            corner = chain[corner]
            if not present[f]:
                continue
            for i in range(3):
                other = head[faces[f, i]]
                while other >= 0:
                    g = other // 3
                    other = chain[other]
                    if not present[g] or asked[g] == turn:
                        continue
                    asked[g] = turn
                    token += 1
                    value = _mean_angle(faces, present, chain, head, normals, g, face_stamp, token)
                    _set_lowest(lowest, width - 1 + g, value)


@njit(cache=True, nogil=True)
def _set_lowest(lowest: Floats, node: int, value: float) -> None:
    lowest[node] = value
    while node > 0:
        node = (node - 1) // 2
        lowest[node] = min(lowest[2 * node + 1], lowest[2 * node + 2])


@njit(cache=True, nogil=True)
def _set_normal(points: Vertices, faces: Ints, face: int, normals: Floats) -> None:
    p, q, r = points[faces[face, 0]], points[faces[face, 1]], points[faces[face, 2]]
    ux, uy, uz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
    vx, vy, vz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    length = math.sqrt(x * x + y * y + z * z)
    normals[face, 0], normals[face, 1], normals[face, 2] = np.nan, np.nan, np.nan
    if length > 0.0:
        normals[face, 0], normals[face, 1], normals[face, 2] = x / length, y / length, z / length


@njit(cache=True, nogil=True)
def _mean_angle(
    faces: Ints, present: Flags, chain: Ints, head: Ints, normals: Floats, face: int, face_stamp: Ints, token: int
) -> float:
    """Mean of `subspace` over the faces with two common vertices, itself among them; infinite for a face without a normal."""
    total, count = 0.0, 0
    for i in range(3):
        corner = head[faces[face, i]]
        while corner >= 0:
            other = corner // 3
            corner = chain[corner]
            if not present[other] or face_stamp[other] == token:
                continue
            common = 0
            for k in range(3):
                common += (
                    faces[other, k] == faces[face, 0] or faces[other, k] == faces[face, 1] or faces[other, k] == faces[face, 2]
                )
            if common < 2:
                continue
            face_stamp[other] = token
            total += _subspace(normals, face, other)
            count += 1
    mean = total / count
    # NaN never is MATLAB's minimum
    return mean if mean == mean else np.inf


@njit(cache=True, nogil=True)
def _subspace(normals: Floats, a: int, b: int) -> float:
    """Angle between the lines along two unit vectors, as MATLAB has it: asin |b - a (a·b)|."""
    cosine = normals[a, 0] * normals[b, 0] + normals[a, 1] * normals[b, 1] + normals[a, 2] * normals[b, 2]
    x, y, z = (
        normals[b, 0] - cosine * normals[a, 0],
        normals[b, 1] - cosine * normals[a, 1],
        normals[b, 2] - cosine * normals[a, 2],
    )
    return math.asin(min(1.0, math.sqrt(x * x + y * y + z * z)))


@njit(cache=True, nogil=True)
def _shortest_side(points: Vertices, faces: Ints, face: int) -> tuple[int, int]:
    """The first of the shortest of sides 1-2, 2-3, 3-1."""
    best, start, end = np.inf, 0, 0
    for i in range(3):
        a, b = faces[face, i], faces[face, (i + 1) % 3]
        length = math.sqrt(
            (points[a, 0] - points[b, 0]) ** 2 + (points[a, 1] - points[b, 1]) ** 2 + (points[a, 2] - points[b, 2]) ** 2
        )
        if length < best:
            best, start, end = length, a, b
    return start, end


@njit(cache=True, nogil=True)
def _add_ring(
    faces: Ints, present: Flags, chain: Ints, head: Ints, vertex: int, stamp: Ints, token: int, near: Ints, size: int
) -> int:
    """Append the vertices of the faces around a vertex that are not in the list yet; returns its new size."""
    corner = head[vertex]
    while corner >= 0:
        if present[corner // 3]:
            for i in range(3):
                other = faces[corner // 3, i]
                if stamp[other] != token:
                    stamp[other] = token
                    near[size] = other
                    size += 1
        corner = chain[corner]
    return size


@njit(cache=True, nogil=True)
def _place(
    points: Vertices,
    faces: Ints,
    present: Flags,
    chain: Ints,
    head: Ints,
    vertex: int,
    weight: float,
    ring: Ints,
    token: int,
    place: Floats,
) -> None:
    """Where smoothing puts a vertex, into place (3,); one without faces stays."""
    x, y, z, count = 0.0, 0.0, 0.0, 0
    corner = head[vertex]
    while corner >= 0:
        if present[corner // 3]:
            for i in range(3):
                other = faces[corner // 3, i]
                if other != vertex and ring[other] != token:
                    ring[other] = token
                    x, y, z, count = x + points[other, 0], y + points[other, 1], z + points[other, 2], count + 1
        corner = chain[corner]
    share = weight if count else 0.0
    scale = 1.0 / max(count, 1)
    place[0] = points[vertex, 0] + share * (x * scale - points[vertex, 0])
    place[1] = points[vertex, 1] + share * (y * scale - points[vertex, 1])
    place[2] = points[vertex, 2] + share * (z * scale - points[vertex, 2])
