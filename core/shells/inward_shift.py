"""The nodal movement that shifts every face around a vertex by at least the same distance."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import Rows
from core.geometry.chunks import in_chunks
from core.geometry.normals import face_normals
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]

LONGEST_SHIFT = 4.0  # at a needle's tip the movement that shifts all faces by 1 grows without bound
MOST_FACES = 64
ROUNDS = 300
FLAT_COSINE = 0.995  # where all normals are this near their mean, its direction is the answer to half a percent
SETTLED = 1e-5  # a round that changes no weight by more is the last


def inward_shift(vertices: Vertices, faces: Faces, around: Rows, chosen: NDArray[np.int64] | None = None) -> Floats:
    """Shortest movement s of each vertex with n_i · s <= -1 for all faces i around it, (V, 3) per mm.

    Moving by `d * s` shifts every face by at least d; where all normals make one angle with an axis this is exactly
    thesis Eq. (4.1), d n0 / |n0|², but it does not depend on the areas of the faces and holds at saddles too.
    around: faces of each vertex. chosen (N,): only these vertices, (N, 3) then. Longer than `LONGEST_SHIFT` is cut off.
    Source: Eq. (4.1); the small quadratic programs are solved by Hildreth's method.
    """
    asked = np.arange(len(vertices)) if chosen is None else chosen
    shift = np.empty((len(asked), 3))
    normals = face_normals(vertices, faces)
    in_chunks(len(asked), lambda start, end: _shift(normals, around.start, around.values, asked[start:end], shift[start:end]))
    return shift


@njit(cache=True, nogil=True)
def _shift(normals: Floats, start: NDArray[np.int64], values: NDArray[np.int32], asked: NDArray[np.int64], shift: Floats) -> None:
    """normals (F, 3) unit or zero; start (V+1,), values: CSR faces around vertices; shift (N, 3) of asked (N,) is filled."""
    weight = np.empty(MOST_FACES)
    for row in range(len(asked)):
        vertex = asked[row]
        count = min(start[vertex + 1] - start[vertex], MOST_FACES)
        x, y, z, steepest = _along_mean(normals, values, start[vertex], count)
        if steepest > FLAT_COSINE:
            shift[row, 0], shift[row, 1], shift[row, 2] = -x / steepest, -y / steepest, -z / steepest
            continue
        weight[:count] = 0.0
        x, y, z = 0.0, 0.0, 0.0
        for _ in range(ROUNDS):
            change = 0.0
            for i in range(count):
                face = values[start[vertex] + i]
                nx, ny, nz = normals[face, 0], normals[face, 1], normals[face, 2]
                if nx == 0.0 and ny == 0.0 and nz == 0.0:
                    continue
                missing = 1.0 + (nx * x + ny * y + nz * z)
                raised = max(0.0, weight[i] + missing)
                step = raised - weight[i]
                weight[i] = raised
                x, y, z = x - step * nx, y - step * ny, z - step * nz
                change = max(change, abs(step))
            if change < SETTLED:
                break
        length = np.sqrt(x * x + y * y + z * z)
        scale = LONGEST_SHIFT / length if length > LONGEST_SHIFT else 1.0
        shift[row, 0], shift[row, 1], shift[row, 2] = scale * x, scale * y, scale * z


@njit(cache=True, nogil=True)
def _along_mean(normals: Floats, values: NDArray[np.int32], first: int, count: int) -> tuple[float, float, float, float]:
    """Unit mean of the normals of some faces, and its smallest product with one of them; -1 if they cancel out."""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(first, first + count):
        face = values[i]
        x, y, z = x + normals[face, 0], y + normals[face, 1], z + normals[face, 2]
    length = np.sqrt(x * x + y * y + z * z)
    if length == 0.0:
        return 0.0, 0.0, 0.0, -1.0
    x, y, z, steepest = x / length, y / length, z / length, 1.0
    for i in range(first, first + count):
        face = values[i]
        steepest = min(steepest, x * normals[face, 0] + y * normals[face, 1] + z * normals[face, 2])
    return x, y, z, steepest
