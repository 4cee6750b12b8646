"""A surface while faces are taken out of it: arrays that kernels edit in place and nobody else sees.

Corner 3 f + i is corner i of face f. `opposite` names the corner across the side that lies opposite a corner, so walking round
a vertex needs no lists (corner table, Rossignac 1999). Faces and vertices that are gone keep their numbers until the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.decimation.box_tree import box_tree, morton_order
from core.decimation.triangle import triangle
from core.geometry.connectivity import Connectivity
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]
Flags = NDArray[np.bool_]

GONE = -1
QUADRIC = 11  # xx xy xz yy yz zz, x y z, constant, area
AREA = 10


class State(NamedTuple):
    """ids, opposite: (3 F,). corner_of: (V,) any corner there, or GONE. points: (V, 3) mm, exact in float32.

    normals: (F, 3) unit. shape: (F,) quality q. quadrics: (V, 11) about `origin` (3,). boxes: (2 leaves - 1, 6).
    merged_into: (V,) the vertex that took a vertex in, or itself. fixed: (V,) may not move. dirty: (V,) to be smoothed.
    label: (F,) region of each face, the last number for the rest. room: (regions + 1,) faces that may still go there.
    next_member, last_member: (V,) the vertices merged into each, as a chain that starts at itself and ends in GONE.
    """

    ids: Int32s
    opposite: Int32s
    corner_of: Int32s
    points: Floats
    normals: Floats
    shape: Floats
    quadrics: Floats
    origin: Floats
    boxes: Floats
    merged_into: Int32s
    fixed: Flags
    dirty: Flags
    label: Int32s
    room: Ints
    next_member: Int32s
    last_member: Int32s


class Numbering(NamedTuple):
    """Which of the mesh's vertices and faces a state's are: vertex (V,), face (F,)."""

    vertex: Ints
    face: Ints


def begin(mesh: Mesh, label: Int32s, room: Ints, fixed: Flags) -> tuple[State, Numbering]:
    """The state of a whole closed manifold without unused vertices; label: (F,), fixed: (V,).

    Faces are numbered along a space-filling curve and vertices as faces meet them, so that neighbours are near in memory.
    """
    face = morton_order(mesh.vertices[mesh.faces].mean(axis=1))
    corners = mesh.faces[face].ravel()
    rank = np.full(len(mesh.vertices), GONE, dtype=np.int32)
    vertex = np.empty(len(mesh.vertices), dtype=np.int64)
    count = _number(corners, rank, vertex)
    vertex = vertex[:count]
    points = np.ascontiguousarray(mesh.vertices[vertex])
    faces = rank[corners].reshape(-1, 3)
    return _assemble(points, faces, label[face], room, fixed[vertex]), Numbering(vertex, face)


def _assemble(points: Floats, faces: Int32s, label: Int32s, room: Ints, fixed: Flags) -> State:
    net = Connectivity.of(faces, len(points))
    opposite = np.empty(3 * len(faces), dtype=np.int32)
    corner_of = np.empty(len(points), dtype=np.int32)
    _find_opposites(faces, net.faces_around.start, net.faces_around.values, net.neighbours.values, opposite, corner_of)
    normals, shape = np.empty((len(faces), 3)), np.empty(len(faces))
    boxes = box_tree(points, faces)
    origin = 0.5 * (boxes[0, :3] + boxes[0, 3:])
    quadrics = np.zeros((len(points), QUADRIC))
    _measure(points, faces, origin, normals, shape, quadrics)
    numbers = np.arange(len(points), dtype=np.int32)
    return State(
        faces.ravel(), opposite, corner_of, points, normals, shape, quadrics, origin, boxes,
        numbers.copy(), fixed.copy(), np.zeros(len(points), dtype=np.bool_), label.astype(np.int32), room.copy(),
        np.full(len(points), GONE, dtype=np.int32), numbers.copy(),
    )  # fmt: skip


def alive(state: State) -> Ints:
    """Numbers of the faces that are still there."""
    return np.flatnonzero(state.ids[::3] != GONE)


@njit(cache=True, nogil=True)
def _number(corners: Int32s, rank: Int32s, vertex: Ints) -> int:
    """Number vertices in the order of their first corner; rank (V,) must hold GONE. Returns how many there are."""
    count = 0
    for corner in corners:
        if rank[corner] == GONE:
            rank[corner] = count
            vertex[count] = corner
            count += 1
    return count


@njit(cache=True, nogil=True)
def _find_opposites(faces: Int32s, start: Ints, around: Int32s, following: Int32s, opposite: Int32s, corner_of: Int32s) -> None:
    """Fill opposite (3 F,) and corner_of (V,); around, following: the lists of `Connectivity`."""
    for face in range(len(faces)):
        for i in range(3):
            # the side opposite corner i runs from u to v; its other face runs from v to u
            u, v = faces[face, (i + 1) % 3], faces[face, (i + 2) % 3]
            corner_of[faces[face, i]] = 3 * face + i
            for k in range(start[v], start[v + 1]):
                if following[k] == u:
                    other = around[k]
                    for j in range(3):
                        if faces[other, j] != u and faces[other, j] != v:
                            opposite[3 * face + i] = 3 * other + j


@njit(cache=True, nogil=True)
def _measure(points: Floats, faces: Int32s, origin: Floats, normals: Floats, shape: Floats, quadrics: Floats) -> None:
    """Unit normals (F, 3) and q (F,) of faces; each vertex gets the planes of its faces, weighted by a third of their areas."""
    for face in range(len(faces)):
        p, q, r = faces[face, 0], faces[face, 1], faces[face, 2]
        x, y, z, doubled_area, shape[face] = triangle(
            points[p, 0], points[p, 1], points[p, 2], points[q, 0], points[q, 1], points[q, 2],
            points[r, 0], points[r, 1], points[r, 2],
        )  # fmt: skip
        normals[face, 0], normals[face, 1], normals[face, 2] = x, y, z
        weight = doubled_area / 6.0
        d = -(x * (points[p, 0] - origin[0]) + y * (points[p, 1] - origin[1]) + z * (points[p, 2] - origin[2]))
        for i in range(3):
            row = quadrics[faces[face, i]]
            row[0] += weight * x * x
            row[1] += weight * x * y
            row[2] += weight * x * z
            row[3] += weight * y * y
            row[4] += weight * y * z
            row[5] += weight * z * z
            row[6] += weight * x * d
            row[7] += weight * y * d
            row[8] += weight * z * d
            row[9] += weight * d * d
            row[10] += weight
