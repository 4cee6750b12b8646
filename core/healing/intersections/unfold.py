"""Local folds smoothed out: the connectivity stays, a few vertices move."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges, vertex_neighbours
from core.geometry.degenerate import find_degenerate_faces
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.normals import normalised, vertex_normals
from core.healing.intersections.relax import relax
from core.healing.local_crossings import find_near
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STRAY = 1.2  # times the edges around its ring: a vertex farther from the middle of its ring is out of place by itself
STEPS = 40  # of gentle smoothing and of swelling
RINGS_EVERY = 10  # such steps the region grows by a ring
SWELL_SHARE = 0.1  # of an edge: one step outwards
RINGS = 6  # by which a patch may grow
LARGEST_SHARE = 0.3  # of the piece's vertices that a patch may hold


@dataclass(frozen=True, eq=False)
class Neighbourhood:
    """The part of a surface around a cluster, with all that comes near. bad: faces that intersect and are to be mended.

    inverted: faces a part of which looks into space that is wound around negatively. fixed: vertices with faces outside.
    """

    vertices: Vertices
    faces: Faces
    bad: Ints
    inverted: Flags
    fixed: Flags
    tolerated: frozenset[tuple[int, int]]

    def is_clean(self, vertices: Vertices) -> bool:
        """True if nothing intersects any more but what belongs to other clusters, and no face lost its area."""
        pairs = find_intersecting_faces(vertices, self.faces)
        if any((int(a), int(b)) not in self.tolerated for a, b in pairs):
            return False
        return len(find_degenerate_faces(vertices, self.faces)) == 0

    def find_bad(self, vertices: Vertices) -> Ints:
        """Faces that still intersect."""
        pairs = find_intersecting_faces(vertices, self.faces)
        still = [pair for pair in pairs.tolist() if tuple(pair) not in self.tolerated]
        return np.unique(np.array(still, dtype=np.int64))

    def grown(self, free: Flags) -> Flags:
        """The vertices and their neighbours, less the fixed ones."""
        grown = free.copy()
        grown[self.faces[free[self.faces].any(axis=1)]] = True
        return grown & ~self.fixed

    def corners(self, faces: Ints) -> Flags:
        """The vertices of some faces, less the fixed ones."""
        flags = np.zeros(len(self.vertices), dtype=np.bool_)
        flags[self.faces[faces]] = True
        return flags & ~self.fixed


def unfold(
    vertices: Vertices, faces: Faces, cluster: Ints, inverted: Flags, pairs: Ints, tree: FaceTree
) -> tuple[Vertices, Ints] | None:
    """Move vertices around a cluster (K,) of intersecting faces until none of its faces intersects another.

    inverted: (F,). pairs: all that intersect. tree: of the surface, or of it before other clusters were mended. Returns all
    vertices, those outside of the patch as they were, and the numbers of those that were out of place by themselves; or None.
    First vertices that are out of place by themselves are put back; if that does not suffice, whatever moves the least of
    gentle smoothing, swelling of walls that were pushed through each other, and a new smooth patch.
    """
    close = find_near(vertices, faces, cluster, _margin(vertices, faces, cluster), tree)
    close[cluster] = True
    near = np.flatnonzero(close)
    used, corners = np.unique(faces[near], return_inverse=True)
    local = corners.reshape(-1, 3).astype(np.int32)
    number = np.full(len(faces), -1, dtype=np.int64)
    number[near] = np.arange(len(near))
    outer = np.ones(len(faces), dtype=np.bool_)
    outer[near] = False
    fixed = np.isin(used, np.unique(faces[outer]))
    mine = np.isin(pairs, cluster).any(axis=1)
    others = number[pairs[~mine]]
    tolerated = frozenset((int(a), int(b)) for a, b in others[(others >= 0).all(axis=1)].tolist())
    part = Neighbourhood(vertices[used], local, number[cluster], inverted[near], fixed, tolerated)
    strays = _find_strays(part)
    moved = _mend(part, strays)
    if moved is None:
        return None
    result = vertices.copy()
    result[used] = moved
    return result, used[strays].astype(np.int64)


def _margin(vertices: Vertices, faces: Faces, cluster: Ints) -> float:
    """Room around a cluster, mm: a few of its edges."""
    corners = vertices[faces[cluster]]
    return 4.0 * float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))


def _mend(part: Neighbourhood, strays: Flags) -> Vertices | None:
    start = part
    if strays.any():
        put_back = relax(part.vertices, part.faces, strays, 2)
        bad = part.find_bad(put_back)
        if len(bad) == 0:
            return put_back if part.is_clean(put_back) else None
        if len(bad) < len(part.bad):
            start = Neighbourhood(put_back, part.faces, bad, part.inverted, part.fixed, part.tolerated)
    best, least = None, np.inf
    for candidate in _candidates(start):
        distance = float(np.linalg.norm(candidate - start.vertices, axis=1).max())
        if distance < least:
            best, least = candidate, distance
    return best


def _candidates(part: Neighbourhood) -> Iterator[Vertices]:
    """Clean states, one per way that reaches one."""
    swollen, bad = _swell(part)
    for start, left in ((swollen, bad), (part.vertices, part.bad)):
        state = _smooth(part, start, left) if start is not None else None
        if state is not None and part.is_clean(state):
            yield state
    state = _renew(part)
    if state is not None:
        yield state


def _find_strays(part: Neighbourhood) -> Flags:
    """Vertices of bad faces that lie far from the middle of their ring, and farther than their neighbours do."""
    rings = vertex_neighbours(edges(part.faces).ends, len(part.vertices))
    stray = np.zeros(len(part.vertices), dtype=np.bool_)
    for vertex in np.flatnonzero(part.corners(part.bad)).tolist():
        ring = part.vertices[rings[vertex]]
        size = np.median(np.linalg.norm(ring - ring.mean(axis=0), axis=1))
        stray[vertex] = np.linalg.norm(part.vertices[vertex] - ring.mean(axis=0)) > STRAY * size
    return stray


def _smooth(part: Neighbourhood, vertices: Vertices, bad: Ints) -> Vertices | None:
    """Half way to the middle of the neighbours, again and again, where faces still intersect."""
    rings = vertex_neighbours(edges(part.faces).ends, len(part.vertices))
    vertices = vertices.copy()
    for step in range(STEPS):
        if len(bad) == 0:
            return vertices
        free = part.corners(bad)
        for _ in range(step // RINGS_EVERY):
            free = part.grown(free)
        rows = np.flatnonzero(free).tolist()
        middles = np.array([vertices[rings[row]].mean(axis=0) for row in rows])
        vertices[rows] = ((vertices[rows] + middles) / 2).astype(np.float32)
        bad = part.find_bad(vertices)
    return None


def _swell(part: Neighbourhood) -> tuple[Vertices | None, Ints]:
    """Outwards along the normals, where walls have been pushed through each other; and the faces that intersect still."""
    inverted = np.intersect1d(np.flatnonzero(part.inverted), part.bad)
    if len(inverted) == 0:
        return None, part.bad
    ends = edges(part.faces).ends
    rings = vertex_neighbours(ends, len(part.vertices))
    step_mm = SWELL_SHARE * float(np.median(np.linalg.norm(part.vertices[ends[:, 0]] - part.vertices[ends[:, 1]], axis=1)))
    vertices, bad, best = part.vertices.copy(), inverted, (part.vertices, part.bad)
    for step in range(STEPS):
        target = part.corners(bad).astype(float)
        free = part.corners(bad)
        for _ in range(1 + step // RINGS_EVERY):
            free = part.grown(free)
        rows = np.flatnonzero(free).tolist()
        around = [rings[row] for row in rows]
        normals = vertex_normals(vertices, part.faces)
        for _ in range(2):
            target[rows] = np.maximum(target[rows], [0.8 * target[ring].mean() for ring in around])
        normals[rows] = normalised(normals[rows] + np.array([normals[ring].sum(axis=0) for ring in around]))
        vertices[rows] = (vertices[rows] + step_mm * target[rows][:, None] * normals[rows]).astype(np.float32)
        still = part.find_bad(vertices)
        if len(still) < len(best[1]):
            best = vertices.copy(), still
        bad = np.intersect1d(still, inverted)
        if len(bad) == 0:
            break
    return best


def _renew(part: Neighbourhood) -> Vertices | None:
    """A new smooth patch, larger and larger."""
    free = part.corners(part.bad)
    for _ in range(RINGS):
        if free.sum() > max(LARGEST_SHARE * len(part.vertices), 12):
            return None
        for order in (2, 1):
            vertices = relax(part.vertices, part.faces, free, order)
            if part.is_clean(vertices):
                return vertices
        free = part.grown(free)
    return None
