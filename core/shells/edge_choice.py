"""Which edges may be flipped or collapsed at once: greedy, in the order given, no two of them in touch."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]
Flags = NDArray[np.bool_]

GAIN = 1.05  # a flip must raise the lower q of its two faces by this factor
LEAST_VALENCE = 4  # a vertex that loses a neighbour keeps at least three
TURN_COSINE = 0.3  # a face may turn by less than about 70 degrees


@njit(cache=True, nogil=True)
def choose_flips(
    vertices: Floats,
    faces: Int32s,
    face_start: Ints,
    face_values: Int32s,
    ring_start: Ints,
    ring: Int32s,
    asked: Ints,
    begins: Ints,
    allowed: Flags,
    partner: Ints,
) -> None:
    """For face asked[i], flip the side that begins at corner begins[i] if that lifts quality; partner[i]: the other face.

    vertices (V, 3); faces (F, 3); CSR faces around and rings. partner (K,) must hold -1.
    """
    touched = np.zeros(len(vertices), np.bool_)
    old_normal, normal = np.empty(3), np.empty(3)
    for i in range(len(asked)):
        if not allowed[i]:
            continue
        face, at = asked[i], begins[i]
        u, v, tip = faces[face, at], faces[face, (at + 1) % 3], faces[face, (at + 2) % 3]
        other, opposite = -1, -1
        for k in range(face_start[u], face_start[u + 1]):
            g = face_values[k]
            for j in range(3):
                if faces[g, j] == v and faces[g, (j + 1) % 3] == u:
                    other, opposite = g, faces[g, (j + 2) % 3]
        if other < 0 or opposite == tip or touched[u] or touched[v] or touched[tip] or touched[opposite]:
            continue
        if min(ring_start[u + 1] - ring_start[u], ring_start[v + 1] - ring_start[v]) < LEAST_VALENCE:
            continue
        joined = False
        for k in range(ring_start[tip], ring_start[tip + 1]):
            joined = joined or ring[k] == opposite
        if joined:
            continue
        before = min(_quality(vertices, u, v, tip, old_normal), _quality(vertices, v, u, opposite, normal))
        for axis in range(3):
            old_normal[axis] += normal[axis]
        first = _quality(vertices, u, opposite, tip, normal)
        if _dot(normal, old_normal) <= 0.0:
            continue
        second = _quality(vertices, opposite, v, tip, normal)
        if _dot(normal, old_normal) <= 0.0 or min(first, second) < GAIN * before:
            continue
        partner[i] = other
        touched[u] = touched[v] = touched[tip] = touched[opposite] = True


@njit(cache=True, nogil=True)
def choose_collapses(
    vertices: Floats,
    faces: Int32s,
    face_start: Ints,
    face_values: Int32s,
    ring_start: Ints,
    ring: Int32s,
    edges: Ints,
    allowed: Flags,
    strict: bool,
    chosen: Flags,
    places: Floats,
) -> None:
    """Mark edges (K, 2) that may collapse: link condition, no face turned; strict: no lower quality.

    places (K, 3): to the middle or to one of the ends, whatever leaves the better faces.
    Source: link condition, Dey et al. 1999. chosen (K,) must hold False.
    """
    touched = np.zeros(len(vertices), np.bool_)
    stamp = np.full(len(vertices), -1, np.int64)
    place, old_normal, normal = np.empty(3), np.empty(3), np.empty(3)
    for i in range(len(edges)):
        if not allowed[i]:
            continue
        a, b = edges[i, 0], edges[i, 1]
        free = not (touched[a] or touched[b])
        for k in range(ring_start[a], ring_start[a + 1]):
            stamp[ring[k]] = i
            free = free and not touched[ring[k]]
        shared, least = 0, 1 << 30
        for k in range(ring_start[b], ring_start[b + 1]):
            free = free and not touched[ring[k]]
            if stamp[ring[k]] == i:
                shared += 1
                least = min(least, ring_start[ring[k] + 1] - ring_start[ring[k]])
        if not free or shared != 2 or least < LEAST_VALENCE:
            continue
        before, best = 2.0, -1.0
        for end in (a, b):
            for k in range(face_start[end], face_start[end + 1]):
                face = face_values[k]
                before = min(before, _quality(vertices, faces[face, 0], faces[face, 1], faces[face, 2], normal))
        for share in (0.5, 0.0, 1.0):
            for axis in range(3):
                place[axis] = vertices[a, axis] + share * (vertices[b, axis] - vertices[a, axis])
            after = 2.0
            for end in (a, b):
                for k in range(face_start[end], face_start[end + 1]):
                    face = face_values[k]
                    p, q, r = faces[face, 0], faces[face, 1], faces[face, 2]
                    if (p == a or q == a or r == a) and (p == b or q == b or r == b):
                        continue
                    _quality(vertices, p, q, r, old_normal)
                    after = min(after, _moved_quality(vertices, p, q, r, end, place, normal))
                    lengths = np.sqrt(_dot(normal, normal) * _dot(old_normal, old_normal))
                    if _dot(normal, old_normal) <= TURN_COSINE * lengths:
                        after = -1.0
            if after > best:
                best = after
                for axis in range(3):
                    places[i, axis] = place[axis]
        if best < 0.0 or (strict and best < before):
            continue
        chosen[i] = True
        touched[a] = touched[b] = True
        for end in (a, b):
            for k in range(ring_start[end], ring_start[end + 1]):
                touched[ring[k]] = True


@njit(cache=True, nogil=True)
def _dot(a: Floats, b: Floats) -> float:
    product: float = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


@njit(cache=True, nogil=True)
def _quality(vertices: Floats, p: int, q: int, r: int, normal: Floats) -> float:
    """q of a triangle of three vertices; its normal, twice the area long, goes to normal (3,)."""
    shape: float = _shape(
        vertices[p, 0], vertices[p, 1], vertices[p, 2],
        vertices[q, 0], vertices[q, 1], vertices[q, 2],
        vertices[r, 0], vertices[r, 1], vertices[r, 2], normal,
    )  # fmt: skip
    return shape


@njit(cache=True, nogil=True)
def _moved_quality(vertices: Floats, p: int, q: int, r: int, moved: int, place: Floats, normal: Floats) -> float:
    """The same with one of the vertices at another place."""
    px, py, pz = vertices[p, 0], vertices[p, 1], vertices[p, 2]
    qx, qy, qz = vertices[q, 0], vertices[q, 1], vertices[q, 2]
    rx, ry, rz = vertices[r, 0], vertices[r, 1], vertices[r, 2]
    if p == moved:
        px, py, pz = place[0], place[1], place[2]
    if q == moved:
        qx, qy, qz = place[0], place[1], place[2]
    if r == moved:
        rx, ry, rz = place[0], place[1], place[2]
    shape: float = _shape(px, py, pz, qx, qy, qz, rx, ry, rz, normal)
    return shape


@njit(cache=True, nogil=True)
def _shape(
    px: float, py: float, pz: float, qx: float, qy: float, qz: float, rx: float, ry: float, rz: float, normal: Floats
) -> float:
    ux, uy, uz = qx - px, qy - py, qz - pz
    vx, vy, vz = rx - px, ry - py, rz - pz
    wx, wy, wz = rx - qx, ry - qy, rz - qz
    normal[0], normal[1], normal[2] = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    a = np.sqrt(ux * ux + uy * uy + uz * uz)
    b = np.sqrt(vx * vx + vy * vy + vz * vz)
    c = np.sqrt(wx * wx + wy * wy + wz * wz)
    product = a * b * c * (a + b + c)
    if product == 0.0:
        return 0.0
    shape: float = 4.0 * (normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2) / product
    return shape
