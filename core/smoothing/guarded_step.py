"""One step of one surface, shortened where it would break something."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.connectivity import Connectivity
from core.geometry.distance import smallest_gap_between
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.quality import quality
from core.mesh import Faces, Mesh, Vertices
from core.smoothing.delaunay import find_flips
from core.smoothing.spoiled_faces import find_spoiled

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHORTENING = 0.5  # of a vertex' step, each time it takes part in something broken
SMALLEST_SHARE = 0.1  # below, the vertex stays where it is for this step
PASSES = 16  # after so many, whatever is still broken stays where it is
OWN_CLEARANCE_MM = 0.01  # between faces of one surface that share no corner


@dataclass(frozen=True, slots=True)
class Step:
    """What became of a step: vertices that moved, those of them whose way was shortened, and those that had to stay."""

    moved: int
    shortened: int
    held: int


@dataclass(slots=True)
class GuardedSurface:
    """A surface on its way; vertices (V, 3) mm, always exact in float32 and free of self-intersection.

    crowded: (F,) faces nearer to each other than the clearance, as slivers of the input may be. They may stay so, and are
    tested exactly; no others may join them. chosen: (K,) vertices that may move; faces_asked: those around them.
    restrained: (V,) in how many steps each vertex was kept from going all its way.
    """

    vertices: Vertices
    net: Connectivity
    surface: MovingSurface
    chosen: Ints
    faces_asked: Ints
    crowded: Flags
    clearance: Clearance
    restrained: Ints

    @classmethod
    def of(cls, mesh: Mesh, chosen: Ints, clearance: Clearance) -> GuardedSurface:
        """A surface that is free of self-intersection, rounded to float32, and keeps the clearance to its obstacles."""
        # writable copies, as all later states are: numba would compile every kernel again for read-only ones
        vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
        net = Connectivity.of(faces, len(vertices))
        surface = MovingSurface(vertices, faces)
        nobody, never = np.empty(0, np.bool_), np.zeros(len(vertices), dtype=np.int64)
        state = cls(vertices, net, surface, chosen, _faces_of(net, chosen), nobody, clearance, never)
        state._find_crowded()
        return state

    def quality(self) -> Floats:
        """q of the faces that have a say: those around the vertices that may move."""
        return quality(self.vertices, self.net.faces[self.faces_asked])

    def choose(self, vertices: Ints) -> None:
        """Let other vertices (K,) move from now on, ascending."""
        self.chosen, self.faces_asked = vertices, _faces_of(self.net, vertices)

    def step(self, proposal: Vertices, obstacles: tuple[FaceTree, ...], lowest_quality: float | Floats) -> Step:
        """Go to the proposal (V, 3), or as far towards it as everything holds; returns what became of it.

        lowest_quality: no face goes below this q, one for all or one for each (F,), or lower where it is lower.
        Keeps: clearance or, where it was broken, exactly no intersection; no face turns over; coordinates exact in float32.
        Ends, because every pass shortens a vertex' way, and with no way left it is the state before.
        """
        clearance = replace(self.clearance, obstacles=obstacles)
        here, faces = self.vertices, self.net.faces
        share = np.zeros(len(here))
        share[self.chosen] = 1.0
        least = np.zeros(len(faces))
        lowest = np.broadcast_to(lowest_quality, len(faces))[self.faces_asked]
        least[self.faces_asked] = np.minimum(self.quality(), lowest) * (1.0 - 1e-9)
        places = _rounded(proposal)
        asked, suspects = self.faces_asked, np.zeros(len(faces), dtype=np.bool_)
        count = 0
        while True:
            found = self.surface.find_crowded(places, asked, clearance)
            spoiled = find_spoiled(here, places, faces, asked, least)
            new = found[~self.crowded[found]]
            broken = np.union1d(new, spoiled)
            suspects[found[self.crowded[found]]] = True
            if len(broken) == 0:
                broken = self._find_broken(places, np.flatnonzero(suspects), clearance)
                if len(broken) == 0:
                    break
            elif not (share[faces[new]] > 0.0).any(axis=1).all():
                # what came too near a face that stays is one that was crowded before, and is let pass as such
                broken = np.union1d(broken, found)
            back = self.net.corners_of(broken) & (share > 0.0)
            if not back.any():
                break  # all of it lies where it was: at a gap that is just kept, two ways of measuring may differ by a bit
            share[back] = _shortened(share[back], final=count >= PASSES)
            places[back] = _rounded(here[back] + share[back, None] * (proposal[back] - here[back]))
            asked = self.net.faces_of(back)
            count += 1
        moved = (places != here).any(axis=1)
        self.vertices = places
        if self.crowded.any():
            self._find_crowded()
        part = share[self.chosen]
        self.restrained[self.chosen[part < 1.0]] += 1
        return Step(int(moved.sum()), int(((part > 0.0) & (part < 1.0)).sum()), int((part == 0.0).sum()))

    def flip(self, movable: Flags, obstacles: tuple[FaceTree, ...]) -> int:
        """Flip edges towards Delaunay among the movable vertices (V,) as far as the clearance holds; returns how many."""
        clearance = replace(self.clearance, obstacles=obstacles)
        pairs, corners = find_flips(self.vertices, self.net.faces, movable)
        while len(pairs):
            faces = self.net.faces.copy()
            faces[pairs.ravel()] = corners
            surface = self.surface.edited(self.vertices, faces, np.arange(len(faces)))
            crowded = np.isin(pairs, surface.find_crowded(self.vertices, pairs.ravel(), clearance)).any(axis=1)
            if not crowded.any():
                self.net, self.surface = Connectivity.of(faces, self.net.vertex_count), surface
                self.faces_asked = _faces_of(self.net, self.chosen)
                self._find_crowded()
                break
            pairs, corners = pairs[~crowded], corners[np.repeat(~crowded, 2)]
        return len(pairs)

    def place(self, vertices: Vertices, faces: Faces) -> None:
        """Take another state that is known to hold, such as an earlier one."""
        self.vertices = vertices
        if faces is not self.net.faces:
            self.net = Connectivity.of(faces, len(vertices))
            self.surface = MovingSurface(vertices, faces)
            self.faces_asked = _faces_of(self.net, self.chosen)
        self._find_crowded()

    def _find_crowded(self) -> None:
        self.crowded = np.zeros(len(self.net.faces), dtype=np.bool_)
        everything = np.arange(len(self.net.faces))
        self.crowded[self.surface.find_crowded(self.vertices, everything, self.clearance)] = True

    def _find_broken(self, places: Vertices, suspects: Ints, clearance: Clearance) -> Ints:
        """Of faces that were crowded before, those that meet each other, exactly, or are too near an obstacle."""
        if len(suspects) == 0:
            return suspects
        used, corners = np.unique(self.net.faces[suspects], return_inverse=True)
        faces = corners.reshape(-1, 3).astype(np.int32)
        broken = suspects[np.unique(find_intersecting_faces(places[used], faces))]
        for other in clearance.obstacles:
            gap = smallest_gap_between(FaceTree.of(places[used], faces), other)
            if gap.distance_mm < clearance.gap_mm:
                broken = np.union1d(broken, suspects[[gap.face_a]])
        return broken


def _faces_of(net: Connectivity, vertices: Ints) -> Ints:
    flags = np.zeros(net.vertex_count, dtype=np.bool_)
    flags[vertices] = True
    return net.faces_of(flags)


def _shortened(share: Floats, *, final: bool) -> Floats:
    shorter = share * (0.0 if final else SHORTENING)
    shorter[shorter < SMALLEST_SHARE] = 0.0
    return shorter


def _rounded(places: Vertices) -> Vertices:
    """As files hold them."""
    return places.astype(np.float32).astype(np.float64)
