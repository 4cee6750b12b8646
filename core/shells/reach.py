"""How deep a surface lets one go: the inner medial ball at each vertex, measured to the sheet on the other side."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.face_tree import FaceTree, faces_of_leaf, push_children
from core.geometry.normals import face_normals
from core.geometry.triangle_distance import closest_on_triangle
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDS = 40
RELATIVE_STEP = 1e-4  # a ball that shrinks by less is done
FACING = 0.1  # cosine: only faces turned away from the vertex by more than 84 degrees stop its ball


def measure_reach(vertices: Vertices, faces: Faces, normals: Floats, largest_mm: float) -> Floats:
    """Radius of the largest inner ball tangent at each vertex that no facing part of the surface enters, (V,) mm.

    vertices (V, 3) mm, normals (V, 3) unit, outward. Radii are capped at `largest_mm`. A part faces the vertex if its
    normal points away from the vertex's by more than 84°: the other side of a thin part does, the flank of a convex crease
    does not, so a crease, where a layer can retreat, is not taken for thinness.
    Source: shrinking balls, Ma, Bae & Choi 2012, doi:10.1007/s00371-011-0594-7.
    """
    radius = _ball_of_vertices(vertices, normals, largest_mm)
    small = np.flatnonzero(radius < largest_mm * (1 - RELATIVE_STEP))
    if len(small):
        tree = FaceTree.of(vertices, faces)
        facing = np.ascontiguousarray(face_normals(vertices, faces)[tree.face])
        _shrink(tree.boxes, tree.corners, facing, tree.leaves, vertices.copy(), normals, small, largest_mm, radius)
    return radius


def _ball_of_vertices(vertices: Vertices, normals: Floats, largest_mm: float) -> Floats:
    """The ball that no vertex enters, whatever its normal: a quick lower bound that is right on all but few vertices."""
    tree = cKDTree(vertices)
    radius = np.full(len(vertices), largest_mm)
    active = np.arange(len(vertices))
    for _ in range(ROUNDS):
        centre = vertices[active] - radius[active, None] * normals[active]
        distance, found = tree.query(centre)
        nearest = np.asarray(found, dtype=np.int64)
        holds = (distance < radius[active] * (1 - 1e-6)) & (nearest != active)
        active, nearest = active[holds], nearest[holds]
        apart = vertices[active] - vertices[nearest]
        across = 2 * np.einsum("ij,ij->i", apart, normals[active])
        touching = np.einsum("ij,ij->i", apart, apart) / np.maximum(across, 1e-12)
        shrunk = touching < radius[active] * (1 - RELATIVE_STEP)
        radius[active] = np.minimum(radius[active], touching)
        active = active[shrunk]
        if len(active) == 0:
            break
    return radius


@njit(cache=True, nogil=True)
def _shrink(
    boxes: Floats,
    corners: Floats,
    facing: Floats,
    leaves: int,
    vertices: Floats,
    normals: Floats,
    chosen: Ints,
    largest: float,
    radius: Floats,
) -> None:
    """Shrink the balls of chosen vertices until no facing part is inside; facing (F, 3): normals in the order of the tree."""
    stack = np.empty(256, np.int64)
    count = len(corners)
    for vertex in chosen:
        px, py, pz = vertices[vertex, 0], vertices[vertex, 1], vertices[vertex, 2]
        nx, ny, nz = normals[vertex, 0], normals[vertex, 1], normals[vertex, 2]
        ball = largest
        for _ in range(ROUNDS):
            cx, cy, cz = px - ball * nx, py - ball * ny, pz - ball * nz
            best, qx, qy, qz = (ball * (1 - 1e-6)) ** 2, px, py, pz
            stack[0], top = 0, 1
            while top > 0:
                top -= 1
                node = stack[top]
                dx = max(boxes[node, 0] - cx, 0.0, cx - boxes[node, 3])
                dy = max(boxes[node, 1] - cy, 0.0, cy - boxes[node, 4])
                dz = max(boxes[node, 2] - cz, 0.0, cz - boxes[node, 5])
                if dx * dx + dy * dy + dz * dz >= best:
                    continue
                if node < leaves - 1:
                    top = push_children(stack, top, node)
                    continue
                for face in range(*faces_of_leaf(node, leaves, count)):
                    if facing[face, 0] * nx + facing[face, 1] * ny + facing[face, 2] * nz >= FACING:
                        continue
                    squared, x, y, z = closest_on_triangle(cx, cy, cz, corners, face)
                    if squared < best:
                        best, qx, qy, qz = squared, x, y, z
            ax, ay, az = px - qx, py - qy, pz - qz
            across = 2 * (ax * nx + ay * ny + az * nz)
            if across <= 0.0:
                break
            touching = (ax * ax + ay * ay + az * az) / across
            if touching >= ball * (1 - RELATIVE_STEP):
                break
            ball = touching
        radius[vertex] = max(radius[vertex], ball)
