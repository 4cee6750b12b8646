"""One tissue on its way: where it was, where it is, and the guard that keeps it sound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.clearance import Clearance
from core.geometry.face_tree import FaceTree
from core.geometry.normals import mean_normals
from core.geometry.quality import quality
from core.mesh import Mesh, Vertices
from core.separation.spread import least_lengths, spread
from core.shells.independent_sets import independent_sets
from core.smoothing.guarded_step import OWN_CLEARANCE_MM, GuardedSurface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_QUALITY = 0.05  # q to which a face may fall ...
LOST_QUALITY = 0.5  # ... or, where it is poorer, the share of its q it may lose
HELD_SHARE = 0.5  # of a move: a vertex that misses more of it tries again alone
LEAST_NORMAL = 0.5  # length of n0 below which Eq. 4.1 would throw the tip of a spike too far


@dataclass(slots=True)
class Tissue:
    """A surface between other surfaces.

    original: as it came. surface: None if it may not move. floor: (F,) q below which no step takes a face. tree: of the places
    now. edge_mm: (V,) mean length of the edges at each vertex.
    """

    name: str
    original: Mesh
    priority: int
    surface: GuardedSurface | None
    floor: Floats
    tree: FaceTree
    edge_mm: Floats

    @classmethod
    def of(cls, name: str, mesh: Mesh, priority: int, gap_mm: float, *, movable: bool) -> Tissue:
        """Closed, manifold, free of self-intersection, exact in float32."""
        everything = np.arange(len(mesh.vertices))
        own = Clearance(gap_mm, min(OWN_CLEARANCE_MM, gap_mm), ())
        surface = GuardedSurface.of(mesh, everything, own) if movable else None
        floor = np.minimum(LEAST_QUALITY, LOST_QUALITY * quality(mesh.vertices, mesh.faces))
        # writable copies throughout: numba would compile every kernel again for read-only ones
        tree = FaceTree.of(mesh.vertices.copy(), mesh.faces.copy())
        return cls(name, mesh, priority, surface, floor, tree, _mean_edges(mesh))

    @property
    def movable(self) -> bool:
        """May it move at all."""
        return self.surface is not None

    @property
    def vertices(self) -> Vertices:
        """Now, (V, 3) mm."""
        return self.original.vertices if self.surface is None else self.surface.vertices

    def displacement(self) -> Floats:
        """From the original places, (V, 3) mm."""
        moved: Floats = self.vertices - self.original.vertices
        return moved

    def opening_directions(self) -> Floats:
        """n0 / |n0|² of thesis Eq. 4.1, (V, 3): along it by d, every face around goes outwards by about d."""
        means = mean_normals(self.vertices, self.original.faces, weighting="inverse_area")
        squared = np.einsum("ij,ij->i", means, means)
        directions: Floats = means / np.maximum(squared, LEAST_NORMAL * np.sqrt(squared) + 1e-12)[:, None]
        return directions

    def move(self, wish: Floats, longest_mm: float) -> int:
        """Further displacements (V, 3) mm, spread and as far as the surface stays sound; returns how many vertices moved."""
        if self.surface is None:
            return 0
        before, total = self.displacement(), self.displacement() + wish
        total = shortened(spread(self.original.vertices, self.surface.net.neighbours, total), longest_mm)
        moved = self._go(self.surface, total, ())
        # one vertex that cannot move takes its neighbours' moves back with it: try those by themselves
        missing = np.linalg.norm(total - self.displacement(), axis=1)
        held = missing > HELD_SHARE * np.maximum(np.linalg.norm(total - before, axis=1), 1e-300)
        for alone in independent_sets(self.surface.net, held):
            place = self.displacement()
            place[alone] = total[alone]
            moved += self._go(self.surface, place, ())
        return moved

    def ease(self, obstacles: tuple[FaceTree, ...], clearance: Clearance, *, one_by_one: bool) -> int:
        """Back towards the original places as far as the clearance to the obstacles allows; returns how many moves there were.

        A vertex that cannot go back holds its neighbours; one by one they go without it.
        """
        if self.surface is None:
            return 0
        self.surface.clearance = clearance
        total = self.displacement()
        length = np.linalg.norm(total, axis=1)
        # what lies on the slope of a neighbour's move stays with it; everything else tries to go home
        least = least_lengths(self.original.vertices, self.surface.net.neighbours, length)
        share = np.minimum(least / np.maximum(length, 1e-300), 1.0)
        if not one_by_one:
            return self._go(self.surface, share[:, None] * total, obstacles)
        moved = 0
        for alone in independent_sets(self.surface.net, share < 1.0):
            wish = self.displacement()
            wish[alone] *= share[alone, None]
            moved += self._go(self.surface, wish, obstacles)
        return moved

    def _go(self, surface: GuardedSurface, displacement: Floats, obstacles: tuple[FaceTree, ...]) -> int:
        proposal = (self.original.vertices + displacement).astype(np.float32).astype(np.float64)
        surface.choose(np.flatnonzero((proposal != surface.vertices).any(axis=1)))
        if len(surface.chosen) == 0:
            return 0
        step = surface.step(proposal, obstacles, self.floor)
        if step.moved:
            self.tree = FaceTree.of(surface.vertices, surface.net.faces)
        return step.moved


def shortened(vectors: Floats, longest: float) -> Floats:
    """Vectors (N, 3), those longer than the longest cut to it."""
    length = np.linalg.norm(vectors, axis=1)
    cut: Floats = vectors * np.minimum(longest / np.maximum(length, 1e-300), 1.0)[:, None]
    return cut


def _mean_edges(mesh: Mesh) -> Floats:
    sides = np.linalg.norm(mesh.triangles() - np.roll(mesh.triangles(), -1, axis=1), axis=2)
    corners = mesh.faces.ravel()
    both = sides + np.roll(sides, 1, axis=1)  # the two sides at each corner
    count = np.maximum(np.bincount(corners, minlength=len(mesh.vertices)), 1)
    means: Floats = np.bincount(corners, weights=both.ravel(), minlength=len(mesh.vertices)) / (2 * count)
    return means
