"""Self-intersections: local folds are smoothed out, parts that overlap are united."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.distance import closest_points_in
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.healing.change import Change, Staged
from core.healing.fitness import NAME
from core.healing.intersections.arrangement import Arrangement
from core.healing.intersections.clusters import Cluster, find_clusters
from core.healing.intersections.seam import tidy_seam
from core.healing.intersections.short_edges import collapse_short_edges
from core.healing.intersections.unfold import unfold
from core.healing.intersections.unite import unite
from core.mesh import Faces, Mesh, Vertices
from core.run import SILENT, RunContext
from core.schema.counted import counted
from core.validation.self_intersection import check_self_intersection
from core.validation.surface import Surface

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

ROUNDS = 10  # smoothing here may press there; rounding after a union may cross again


def resolve(vertices: Vertices, faces: Faces, run: RunContext = SILENT, farthest_mm: float = math.inf) -> Staged:
    """Free a surface of self-intersection. What could be smoothed out only by moving farther than `farthest_mm` is united.

    Needs:    closed, manifold, oriented faces without any of zero area; coordinates as float32 holds them. One that is not
              closed (any more) comes back for other stages to close.
    Promises: no two faces meet but in shared corners and edges, exactly; vertices away from intersections keep their places;
              same input, same result. A surface that is free already comes back as it is.
    Raises:   InputError `heal.intersections_remain` with places."""
    changes: list[Change] = []
    for number in range(ROUNDS):
        step = run.stage("heal: intersections", number / ROUNDS, (number + 1) / ROUNDS)
        pairs = find_intersecting_faces(vertices, faces)
        if len(pairs) == 0 or (edges(faces).face_count != 2).any():
            return vertices, faces, changes
        step.advance(0.3, f"{len(pairs)} intersecting pairs of faces")
        vertices, faces, done = _mend(vertices, faces, pairs, farthest_mm)
        changes += done
    pairs = find_intersecting_faces(vertices, faces)
    if len(pairs):
        raise _refusal(vertices, faces, pairs)
    return vertices, faces, changes


def unite_overlaps(vertices: Vertices, faces: Faces) -> tuple[Vertices, Faces]:
    """The border of all that a surface holds, however its parts run through each other: no fold is taken for a mistake.

    Needs:    as `resolve`.
    Promises: as `resolve`, if no pair of faces is left that rounding keeps crossed; such are left to others.
    """
    for _ in range(ROUNDS):
        if not len(find_intersecting_faces(vertices, faces)) or (edges(faces).face_count != 2).any():
            break
        vertices, faces, _change = _unite(vertices, faces, Arrangement.of(vertices, faces))
    return vertices, faces


def _mend(vertices: Vertices, faces: Faces, pairs: Ints, farthest_mm: float) -> Staged:
    """One round, of the smallest change that can be made: short edges, then folds, then a union."""
    points, joined, collapsed = collapse_short_edges(vertices, faces, np.unique(pairs))
    if collapsed:
        return points, joined, collapsed
    arrangement = Arrangement.of(vertices, faces)
    inverted = np.zeros(len(faces), dtype=np.bool_)
    inverted[arrangement.birth[arrangement.outside < 0]] = True
    _, piece = face_components(edges(faces))
    clusters = find_clusters(faces, len(vertices), pairs)
    folds = [cluster for cluster in clusters if _is_fold(cluster, piece, inverted)]
    unfolded, change = _unfold_all(vertices, faces, folds, inverted, pairs, farthest_mm)
    if change is not None:
        return unfolded, faces, [change]
    if not (arrangement.outside == 0).any():  # all inside out: there is no inside to unite
        return vertices, faces, []
    points, joined, change = _unite(vertices, faces, arrangement)
    return points, joined, [change]


def _is_fold(cluster: Cluster, piece: Ints, inverted: Flags) -> bool:
    """One part of one piece that runs through itself, or parts that were pushed through each other from inside."""
    if len(np.unique(piece[cluster.faces])) > 1:
        return False
    return cluster.patches == 1 or bool(inverted[cluster.faces].any())


def _unfold_all(
    vertices: Vertices, faces: Faces, folds: list[Cluster], inverted: Flags, pairs: Ints, farthest_mm: float
) -> tuple[Vertices, Change | None]:
    """Smooth out what can be; no change if nothing can. Faces around vertices that were out of place count as replaced."""
    if not folds:
        return vertices, None
    before, points, distances, replaced = vertices, [], [], np.zeros(len(faces), dtype=np.bool_)
    tree = FaceTree.of(vertices, faces)
    for cluster in folds:
        mended = unfold(vertices, faces, cluster.faces, inverted, pairs, tree)
        if mended is None:
            continue
        rows = np.flatnonzero((mended[0] != vertices).any(axis=1))
        if closest_points_in(tree, mended[0][rows])[0].max() > farthest_mm:
            continue  # no fold but a part that runs into another, as an arm into the torso up to the armpit
        away = np.linalg.norm(mended[0][rows] - vertices[rows], axis=1)
        points.append(before[rows[away.argmax()]])
        distances.append(away.max())
        vertices = mended[0]
        replaced |= np.isin(faces, mended[1]).any(axis=1)
    if not points:
        return before, None
    message = f"{len(points)} folds were smoothed out, moving vertices by {max(distances):.3g} mm at most"
    taken, added = before[faces[replaced]], vertices[faces[replaced]]
    return vertices, Change("folds", message, np.array(points), np.array(distances), taken, added)


def _unite(vertices: Vertices, faces: Faces, arrangement: Arrangement) -> tuple[Vertices, Faces, Change]:
    """The union of all parts; its seams are where new faces are."""
    points, joined, is_new, birth = unite(vertices, faces, arrangement)
    points, joined = tidy_seam(points, joined, is_new, face_components(edges(faces))[1][birth])
    gone = np.setdiff1d(faces, joined)
    places = points[len(vertices) :]
    distance = closest_points_in(FaceTree.of(vertices, faces), places)[0]
    message = f"parts that overlap were united; {len(gone)} vertices inside are gone, {len(places)} are new along the seams"
    return points, joined, Change("overlaps", message, places, distance)


def _refusal(vertices: Vertices, faces: Faces, pairs: Ints) -> InputError:
    used, corners = np.unique(faces, return_inverse=True)
    findings = tuple(check_self_intersection(Surface(NAME, Mesh.of(vertices[used], corners.reshape(-1, 3)), pairs)))
    places = len(find_clusters(faces, len(vertices), pairs))
    message = f"{len(pairs)} pairs of faces in {counted(places, 'place')} still intersect after {ROUNDS} rounds of mending"
    return InputError("heal.intersections_remain", message, findings=findings, count=len(pairs), places=places)
