"""The value of a field at any point, and how far from there it is known."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.fields.containing import NOWHERE, TetrahedronTree
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
FACES_OF_TETRAHEDRON = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # each opposite the corner of its number


@dataclass(frozen=True, eq=False, slots=True)
class Sampled:
    """Values (N, c) at points, and the distance (N,) mm to the place they were taken from."""

    values: Floats
    distance_mm: Floats


class Sampler(Protocol):
    """A field that can be asked anywhere."""

    def sample(self, points: Floats) -> Sampled:
        """At points (N, 3) mm."""
        ...


class PointSampler:
    """Scattered points: the nearest, or the mean of the nearest few weighted by the inverse square of their distance."""

    def __init__(self, points: Floats, values: Floats) -> None:
        """points (N, 3) mm, values (N, c); N >= 1."""
        self._tree = cKDTree(points)
        self._values = values

    def sample(self, points: Floats, neighbours: int = 1) -> Sampled:
        """1 neighbour: the nearest. A point that lies on one of the source has its value."""
        found = self._tree.query(points, k=np.arange(1, min(neighbours, len(self._values)) + 1))
        distance, number = np.asarray(found[0]), np.asarray(found[1])
        with np.errstate(divide="ignore", over="ignore"):
            weights = 1.0 / distance**2
        on_one = ~np.isfinite(weights).all(axis=1)
        weights[on_one] = ~np.isfinite(weights[on_one])
        weights /= weights.sum(axis=1, keepdims=True)
        return Sampled(np.einsum("nk,nkc->nc", weights, self._values[number]), distance[:, 0])


class InverseDistanceSampler:
    """The nearest points of a `PointSampler`, weighted."""

    def __init__(self, points: PointSampler, neighbours: int) -> None:
        self._points, self._neighbours = points, neighbours

    def sample(self, points: Floats) -> Sampled:
        """As `Sampler`."""
        return self._points.sample(points, self._neighbours)


class TriangleSampler:
    """A field on triangles, taken at the closest point: linear with values at nodes, constant with values of triangles."""

    def __init__(self, nodes: Floats, triangles: Ints, values: Floats, at_nodes: bool) -> None:
        """values: a row per node, or per triangle."""
        self._nodes, self._triangles, self._values, self._at_nodes = nodes, triangles, values, at_nodes
        self._tree = FaceTree.of(nodes, triangles)

    def sample(self, points: Floats) -> Sampled:
        """As `Sampler`."""
        distance, place, triangle = closest_points_in(self._tree, points)
        if not self._at_nodes:
            return Sampled(self._values[triangle], distance)
        corners = self._triangles[triangle]
        weights = _weights_in_triangles(self._nodes[corners], place)
        return Sampled(np.einsum("nk,nkc->nc", weights, self._values[corners]), distance)


class TetrahedronSampler:
    """A field in tetrahedra, taken in the one that holds the point: linear with values at nodes, constant with values of
    tetrahedra. Outside of all it is taken at the closest point of their border, and the distance says so."""

    def __init__(self, nodes: Floats, tetrahedra: Ints, values: Floats, at_nodes: bool) -> None:
        """values: a row per node, or per tetrahedron."""
        self._nodes, self._tetrahedra, self._values, self._at_nodes = nodes, tetrahedra, values, at_nodes
        self._tree = TetrahedronTree.of(nodes[tetrahedra])

    def sample(self, points: Floats) -> Sampled:
        """As `Sampler`."""
        found, weights = self._tree.find(points)
        distance = np.zeros(len(points))
        outside = np.flatnonzero(found == NOWHERE)
        if len(outside):
            tree, owner, corners = self._border
            distance[outside], place, face = closest_points_in(tree, points[outside])
            found[outside] = owner[face]
            on_face = _weights_in_triangles(self._nodes[corners[face]], place)
            same = self._tetrahedra[owner[face]][:, :, None] == corners[face][:, None, :]
            weights[outside] = np.einsum("nck,nk->nc", same, on_face)
        if not self._at_nodes:
            return Sampled(self._values[found], distance)
        return Sampled(np.einsum("nk,nkc->nc", weights, self._values[self._tetrahedra[found]]), distance)

    @cached_property
    def _border(self) -> tuple[FaceTree, NDArray[np.int64], Ints]:
        """Faces of one tetrahedron only: their tree, the tetrahedron of each, and their corners."""
        faces = np.concatenate([self._tetrahedra[:, corners] for corners in FACES_OF_TETRAHEDRON])
        owner = np.tile(np.arange(len(self._tetrahedra)), len(FACES_OF_TETRAHEDRON))
        _, first, counts = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
        lone = first[counts == 1]
        return FaceTree.of(self._nodes, faces[lone]), owner[lone], faces[lone]


def _weights_in_triangles(corners: Floats, places: Floats) -> Floats:
    """Barycentric weights (N, 3) of places (N, 3) in the planes of triangles (N, 3, 3); of one without area its mean."""
    u, v, w = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], places - corners[:, 0]
    uu, uv, vv = (np.einsum("nd,nd->n", *pair) for pair in ((u, u), (u, v), (v, v)))
    wu, wv = (np.einsum("nd,nd->n", w, side) for side in (u, v))
    area = uu * vv - uv * uv
    flat = area <= 1e-12 * uu * vv
    area[flat] = 1.0
    weights = np.column_stack([np.zeros(len(area)), (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area])
    weights[:, 0] = 1.0 - weights[:, 1] - weights[:, 2]
    weights[flat] = 1.0 / 3.0
    return weights
