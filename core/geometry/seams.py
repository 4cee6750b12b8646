"""Good triangles along the seams that a subtraction leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.adjacency import edges
from core.geometry.cut_surface import SKIN, CutSurface
from core.geometry.distance import closest_points_in
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.patch import Patch
from core.geometry.quality import quality, side_lengths
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

RINGS = 3  # of vertices to each side of the seam may change
ROUNDS = 8
GROWTH = 0.5  # how much longer edges may get per length away from the seam
LONGEST, SHORTEST = 1.4, 0.6  # times the length wanted: longer edges are split, shorter ones collapsed
TOLERANCE_MM = 0.15
POOR = 0.3
SMOOTHING_KEEPS = 0.5


@dataclass(frozen=True, eq=False, slots=True)
class RemeshedSurface:
    """A cut surface with good seams. piece: (F,) as in CutSurface; kept: faces, the first ones, that are the base's before
    the cut bit for bit; moved_mm: how far the new surface lies from base and solids at most; lowest_quality: of new faces."""

    mesh: Mesh
    piece: Ints
    kept: int
    moved_mm: float
    lowest_quality: float


def remesh_around_seams(
    cut: CutSurface,
    base: Mesh,
    solids: Sequence[Mesh],
    *,
    may_change: NDArray[np.bool_] | None = None,
    tolerance_mm: float = TOLERANCE_MM,
) -> RemeshedSurface | None:
    """Split, collapse, flip and smooth around the seams; None if no state of them passed the exact test.

    Needs:    a base with solids cut out of it, whose walls are numbered as `solids` are. may_change: (F,) faces of the cut
              surface that may, all if none are named.
    Promises: closed manifold of the same genus without self-intersection (exact), coordinates exact in float32; faces
              farther than 3 rings from a seam unchanged bit for bit.
    Source:   local remeshing after Botsch & Kobbelt 2004, doi:10.1145/1057432.1057457, with a seam kept as a line.
    """
    sizing = _Sizing.of(cut)
    chosen = _near_seams(cut)
    if may_change is not None:
        chosen &= may_change
    patch = Patch.of(cut.mesh, cut.piece, chosen, tolerance_mm)
    fixed = np.flatnonzero(~chosen)
    trees = {SKIN: FaceTree.of(base.vertices, base.faces)}
    trees |= {number: FaceTree.of(solid.vertices, solid.faces) for number, solid in enumerate(solids)}
    best: RemeshedSurface | None = None
    for _ in range(ROUNDS):
        _improve(patch, sizing)
        _smooth(patch, trees)
        state = _assemble(cut, patch, fixed, trees)
        if (best is None or state.lowest_quality > best.lowest_quality) and not _crosses_itself(state, patch):
            best = state
    return best


@dataclass(frozen=True, eq=False, slots=True)
class _Sizing:
    """Edge lengths wanted: at (S, 3) places on the seam `wanted` (S,) mm, growing away from it."""

    tree: cKDTree
    wanted: Floats

    @classmethod
    def of(cls, cut: CutSurface) -> _Sizing:
        """The shorter of the usual edges of skin and canal near each seam."""
        sides = side_lengths(cut.mesh.vertices, cut.mesh.faces)
        places, wanted = [], []
        for number in range(int(cut.piece.max()) + 1):
            line = np.unique(_seam_ends(cut, number))
            if len(line) == 0:
                continue  # a solid that came to lie in air
            points = cut.mesh.vertices[line]
            wall = np.median(sides[cut.piece == number])
            spread = float(np.ptp(points, axis=0).max())
            near = np.linalg.norm(cut.mesh.triangles().mean(axis=1) - points.mean(axis=0), axis=1) < 2 * spread
            beside = sides[near & (cut.piece == SKIN)]
            places.append(points)
            wanted.append(np.full(len(points), min(float(wall), float(np.median(beside)))))
        return cls(cKDTree(np.concatenate(places)), np.concatenate(wanted))

    def at(self, points: Floats) -> Floats:
        """(N,) mm at points (N, 3)."""
        distance, nearest = self.tree.query(points)
        length: Floats = self.wanted[nearest] + GROWTH * distance
        return length


def _seam_ends(cut: CutSurface, number: int) -> Ints:
    """Edges (E, 2) between the wall of a canal and something else."""
    net = edges(cut.mesh.faces)
    edge, pair, _side = net.two_faces()
    owner = cut.piece[pair]
    found: Ints = net.ends[edge[(owner[:, 0] != owner[:, 1]) & (owner == number).any(axis=1)]]
    return found


def _near_seams(cut: CutSurface) -> NDArray[np.bool_]:
    """Faces (F,) within RINGS rings of vertices from a seam."""
    reached = np.zeros(len(cut.mesh.vertices), dtype=np.bool_)
    for number in range(int(cut.piece.max()) + 1):
        reached[_seam_ends(cut, number)] = True
    for _ in range(RINGS):
        faces = reached[cut.mesh.faces].any(axis=1)
        reached[cut.mesh.faces[faces]] = True
    return np.asarray(reached[cut.mesh.faces].all(axis=1))


def _improve(patch: Patch, sizing: _Sizing) -> None:
    """Edges of the length wanted, then the better diagonals, then whatever rids of poor triangles."""
    for edge, length, wanted in _lengths(patch, sizing):
        if length > LONGEST * wanted and len(patch.at_edge(*edge)) == 2:
            patch.split(*edge)
    for edge, length, wanted in sorted(_lengths(patch, sizing), key=lambda row: (row[1] / row[2], row[0])):
        if length < SHORTEST * wanted:
            _collapse(patch, *edge, 0.5 * POOR)
    _flip_all(patch)
    for number in sorted(patch.triangles):
        if number in patch.triangles and patch.lowest_quality((patch.triangles[number],)) < POOR:
            a, b, c = patch.triangles[number]
            for edge in sorted(((a, b), (b, c), (c, a)), key=lambda pair: (patch.length(*pair), pair)):
                if _collapse(patch, *edge, POOR):
                    break
    _flip_all(patch)


def _collapse(patch: Patch, u: int, v: int, least_quality: float) -> bool:
    return patch.collapse(u, v, least_quality) or patch.collapse(v, u, least_quality)


def _flip_all(patch: Patch) -> None:
    for edge in patch.edges():
        patch.flip(*edge)


def _lengths(patch: Patch, sizing: _Sizing) -> list[tuple[tuple[int, int], float, float]]:
    """Edges inside the patch with their length and the length wanted, mm."""
    inner = patch.edges()
    ends = np.array(patch.points)[np.array(inner)]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return list(zip(inner, length.tolist(), sizing.at(ends.mean(axis=1)).tolist(), strict=True))


def _smooth(patch: Patch, trees: dict[int, FaceTree]) -> None:
    """Vertices off the seam to the middle of their triangles, back onto the surface they belong to; those on it to the
    middle between their neighbours, along the seam."""
    free = [vertex for vertex in sorted(patch.around) if patch.around[vertex] and vertex not in patch.rim]
    for piece, tree in trees.items():
        own = [vertex for vertex in free if not patch.is_seam(vertex) and patch.piece[min(patch.around[vertex])] == piece]
        if own:
            wanted = np.array([_middle(patch, vertex) for vertex in own])
            _distance, places, _face = closest_points_in(tree, wanted)
            for vertex, place in zip(own, places.astype(np.float32).tolist(), strict=True):
                patch.move(vertex, tuple(place), SMOOTHING_KEEPS)
    for vertex in free:
        if patch.is_seam(vertex):
            _slide(patch, vertex)


def _middle(patch: Patch, vertex: int) -> Floats:
    """Mean of the centres of the triangles around a vertex, weighted by area, (3,)."""
    corners = np.array([[patch.points[other] for other in patch.triangles[number]] for number in sorted(patch.around[vertex])])
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    middle: Floats = (corners.mean(axis=1) * areas[:, None]).sum(axis=0) / max(float(areas.sum()), 1e-12)
    return middle


def _slide(patch: Patch, vertex: int) -> None:
    """Along the seam to the point halfway between its two neighbours on it; at a corner of the seam nothing moves."""
    neighbours = patch.seam_neighbours(vertex)
    here = np.array(patch.points[vertex])
    if len(neighbours) == 2:
        first, second = (np.array(patch.points[other]) for other in neighbours)
        before, after = np.linalg.norm(first - here), np.linalg.norm(second - here)
        farther, length = (first, before) if before > after else (second, after)
        if length > 0.0:
            place = here + (farther - here) * abs(before - after) / (2 * length)
            patch.move(vertex, tuple(place.astype(np.float32).tolist()), SMOOTHING_KEEPS)


def _assemble(cut: CutSurface, patch: Patch, fixed: Ints, trees: dict[int, FaceTree]) -> RemeshedSurface:
    """The surface with the patch as it is now: kept faces first, all vertices exact in float32."""
    numbers = sorted(patch.triangles)
    inner = np.array([patch.triangles[number] for number in numbers], dtype=np.int64)
    faces = np.concatenate((cut.mesh.faces[fixed], inner))
    owner = np.concatenate((cut.piece[fixed], np.array([patch.piece[number] for number in numbers])))
    points = np.array(patch.points).astype(np.float32).astype(np.float64)
    kept = int((fixed < cut.kept).sum())
    used, renumbered = np.unique(faces, return_inverse=True)
    mesh = Mesh.of(points[used], renumbered.reshape(-1, 3))
    lowest = float(quality(points, inner.astype(np.int32)).min())
    moved = 0.0
    for piece, tree in trees.items():
        corners = np.unique(inner[owner[len(fixed) :] == piece])
        if len(corners):
            moved = max(moved, float(closest_points_in(tree, points[corners])[0].max()))
    return RemeshedSurface(mesh, owner, kept, moved, lowest)


def _crosses_itself(state: RemeshedSurface, patch: Patch) -> bool:
    """Exact test of all faces near the patch."""
    corners = state.mesh.triangles()
    new = corners[-len(patch.triangles) :]
    low, high = new.min(axis=(0, 1)), new.max(axis=(0, 1))
    near = (corners.max(axis=1) >= low).all(axis=1) & (corners.min(axis=1) <= high).all(axis=1)
    return len(find_intersecting_faces(state.mesh.vertices, state.mesh.faces[near])) > 0
