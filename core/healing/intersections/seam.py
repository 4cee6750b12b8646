"""Better triangles along the seams of a union, where cut faces are slivers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.degenerate import find_degenerate_faces
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.patch import Patch
from core.geometry.quality import side_lengths
from core.healing.local_crossings import find_crossings_of
from core.mesh import Faces, Mesh, Vertices

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

POOR = 0.2  # q below which a triangle is to go
TOLERANCE_SHARE = 0.005  # of the median edge: how far an edit may take the surface from where it was
ROUNDS = 4


def tidy_seam(vertices: Vertices, faces: Faces, is_new: Flags, piece: Ints) -> tuple[Vertices, Faces]:
    """Collapse and flip edges among the new faces (G,) where triangles are poor.

    piece (G,): the part of the surface each face comes from; edges between parts, the seam, stay where they are. Faces that
    are not new stay bit for bit and keep their order. If more faces intersect afterwards than before, nothing is changed.
    """
    if not is_new.any():
        return vertices, faces
    mesh = Mesh.of(vertices, faces)
    found = edges(faces)
    if (found.face_count != 2).any():
        return vertices, faces
    patch = Patch.of(mesh, piece, is_new, TOLERANCE_SHARE * float(np.median(side_lengths(vertices, faces))))
    tree = FaceTree.of(vertices, faces[is_new])
    for _ in range(ROUNDS):
        if not _improve(patch, tree):
            break
    numbers = sorted(patch.triangles)
    inner = np.array([patch.triangles[number] for number in numbers], dtype=np.int32).reshape(-1, 3)
    tidied = np.concatenate((faces[~is_new], inner))
    if _count_faults(vertices, tidied, int((~is_new).sum())) > _count_faults(
        vertices, np.concatenate((faces[~is_new], faces[is_new])), int((~is_new).sum())
    ):
        return vertices, faces
    return vertices, tidied


def _improve(patch: Patch, tree: FaceTree) -> bool:
    """One round over the poor triangles; True if any was collapsed."""
    changed = False
    for number in sorted(patch.triangles):
        if number not in patch.triangles or patch.lowest_quality((patch.triangles[number],)) >= POOR:
            continue
        a, b, c = patch.triangles[number]
        for u, v in sorted(((a, b), (b, c), (c, a)), key=lambda pair: (patch.length(*pair), pair)):
            if _collapse(patch, tree, u, v) or _collapse(patch, tree, v, u):
                changed = True
                break
    for edge in patch.edges():
        patch.flip(*edge)
    return changed


def _collapse(patch: Patch, tree: FaceTree, gone: int, kept: int) -> bool:
    """Collapse if also the middles of the new triangles and of their sides stay near the surface that was (tree)."""
    after = [
        [patch.points[kept if vertex == gone else vertex] for vertex in patch.triangles[number]]
        for number in sorted(patch.around[gone] - patch.around[kept])
    ]
    if gone in patch.rim or not after:
        return False
    corners = np.array(after)
    points = np.concatenate((corners.mean(axis=1), ((corners + np.roll(corners, 1, axis=1)) / 2).reshape(-1, 3)))
    if closest_points_in(tree, points)[0].max() > patch.tolerance_mm:
        return False
    return patch.collapse(gone, kept, POOR)


def _count_faults(vertices: Vertices, faces: Faces, kept: int) -> int:
    """Intersecting pairs among and with the faces from `kept` on, and faces without area."""
    chosen = np.arange(kept, len(faces))
    return len(find_crossings_of(vertices, faces, chosen)) + len(find_degenerate_faces(vertices, faces[chosen]))
