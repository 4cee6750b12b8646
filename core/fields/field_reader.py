"""One field, asked for the triangles of one surface after another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.field_source import FieldData, FieldMesh
from core.fields.asked_columns import FieldPoints
from core.fields.mapped import MappedField
from core.fields.samplers import InverseDistanceSampler, PointSampler, Sampler, TetrahedronSampler, TriangleSampler
from core.geometry.normals import face_normals
from core.mesh import Mesh
from core.schema.fields import V_PER_M, FieldParameters

Floats = NDArray[np.float64]
SAME_PLACE_MM = 0.01  # files with four digits behind the point have no better
BELOW_MM = 1e-3  # values of tetrahedra jump between tissues: a triangle between two has that of its inner side
CORNERS = np.eye(3)
CENTRE = np.full((1, 3), 1.0 / 3.0)
INTERIOR = np.array([[4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]]) / 6.0  # mean exact up to degree 2
USUAL_DATA = ("E", "magnE", "normE", "magE")


@dataclass(frozen=True, eq=False, slots=True)
class _Way:
    """Whom to ask, at which places of a triangle (weights of its corners, (S, 3)), and how that is called."""

    sampler: Sampler
    places: Floats
    words: str
    below_mm: float = 0.0


class FieldReader:
    """Points of a table, or a mesh with the data that was asked for."""

    def __init__(self, source: FieldPoints | FieldMesh, asked: FieldParameters) -> None:
        """Raises: InputError `fields.method_unfit`, `fields.data_unknown`, `fields.not_a_field`."""
        self._asked = asked
        self._mesh = source if isinstance(source, FieldMesh) else None
        self._data = None if self._mesh is None else choose_data(self._mesh, asked.data)
        self._table = source if isinstance(source, FieldPoints) else None
        if self._mesh is None and asked.method == "containing":
            raise InputError(
                "fields.method_unfit", "a matrix of points has no elements to contain a triangle: use nearest or inverse_distance"
            )

    def map_onto(self, surface: Mesh) -> MappedField:
        """The mean over each triangle; NaN where it is farther than asked from the field."""
        way = self._way_for(surface)
        corners = surface.triangles()
        shift = -max(self._asked.inward_mm, way.below_mm) * face_normals(surface.vertices, surface.faces)
        points = np.einsum("sk,fkd->fsd", way.places, corners) + shift[:, None, :]
        sampled = way.sampler.sample(points.reshape(-1, 3))
        count = len(way.places)
        distance = sampled.distance_mm.reshape(-1, count).max(axis=1)
        means = sampled.values.reshape(len(corners), count, -1).mean(axis=1) * V_PER_M[self._asked.field_unit]
        means[distance > self._asked.max_distance_mm] = np.nan
        return MappedField(means, distance, way.words)

    def places(self) -> Floats:
        """Where the field is known, (N, 3) mm."""
        return self._known[0]

    def _way_for(self, surface: Mesh) -> _Way:
        method = self._asked.method
        if method == "nearest":
            return _Way(self._points, INTERIOR, "nearest point of the field")
        if method == "inverse_distance" or (method == "auto" and self._mesh is None):
            exact = self._exact_way(surface) if method == "auto" else None
            return exact or self._weighted_way()
        if self._triangles is not None and (self._tetrahedra is None or self._lies_on_triangles(surface)):
            return _Way(self._triangles, INTERIOR, "triangle of the field at the closest place")
        if self._tetrahedra is None:
            return self._weighted_way()  # values at nodes that belong to no element
        return _Way(self._tetrahedra, INTERIOR, "tetrahedron of the field that holds the place", BELOW_MM)

    def _weighted_way(self) -> _Way:
        words = f"{self._asked.neighbours} nearest points weighted by the inverse square of the distance"
        return _Way(InverseDistanceSampler(self._points, self._asked.neighbours), INTERIOR, words)

    def _exact_way(self, surface: Mesh) -> _Way | None:
        """If the points are the vertices of the surface, or the centres of its triangles, there is nothing to be guessed."""
        if self._asked.inward_mm > 0.0:
            return None
        for places, points, words in (
            (
                CORNERS,
                surface.vertices[np.unique(surface.faces)],
                "mean of the values at the corners, which are points of the field",
            ),
            (CENTRE, surface.triangles().mean(axis=1), "value at the centre of the triangle, which is a point of the field"),
        ):
            if (self._points.sample(points).distance_mm <= SAME_PLACE_MM).all():
                return _Way(self._points, places, words)
        return None

    def _lies_on_triangles(self, surface: Mesh) -> bool:
        """True if the field has values on the very triangles of the surface: better than those of tetrahedra beside it."""
        if self._triangles is None or self._asked.inward_mm > 0.0:
            return False
        centres = surface.triangles().mean(axis=1)
        return bool((self._triangles.sample(centres).distance_mm <= SAME_PLACE_MM).all())

    @cached_property
    def _known(self) -> tuple[Floats, Floats]:
        """Points and values: nodes, or the middles of elements."""
        if self._table is not None:
            return self._table.points, self._table.values
        mesh, data = self._required()
        if data.where == "nodes":
            return mesh.nodes, data.values
        kinds = (mesh.triangles, mesh.tetrahedra)
        middles = np.concatenate([mesh.nodes[kind].mean(axis=1) for kind in kinds])
        there = np.isfinite(data.values).all(axis=1)
        return middles[there], data.values[there]

    @cached_property
    def _points(self) -> PointSampler:
        return PointSampler(*self._known)

    @cached_property
    def _triangles(self) -> TriangleSampler | None:
        mesh, data = self._required()
        if data.where == "nodes":
            return TriangleSampler(mesh.nodes, mesh.triangles, data.values, at_nodes=True) if len(mesh.triangles) else None
        values = data.values[: len(mesh.triangles)]
        there = np.isfinite(values).all(axis=1)
        return TriangleSampler(mesh.nodes, mesh.triangles[there], values[there], at_nodes=False) if there.any() else None

    @cached_property
    def _tetrahedra(self) -> TetrahedronSampler | None:
        mesh, data = self._required()
        if data.where == "nodes":
            return TetrahedronSampler(mesh.nodes, mesh.tetrahedra, data.values, at_nodes=True) if len(mesh.tetrahedra) else None
        values = data.values[len(mesh.triangles) :]
        there = np.isfinite(values).all(axis=1)
        return TetrahedronSampler(mesh.nodes, mesh.tetrahedra[there], values[there], at_nodes=False) if there.any() else None

    def _required(self) -> tuple[FieldMesh, FieldData]:
        if self._mesh is None or self._data is None:
            raise TypeError("a table has no elements")
        return self._mesh, self._data


def choose_data(mesh: FieldMesh, name: str | None) -> FieldData:
    """The data of that name; without one a usual name, or the only data there is.

    Raises: InputError `fields.data_unknown`, `fields.no_values`."""
    named = {each.name: each for each in mesh.data}
    usual = next((each for each in USUAL_DATA if each in named), None)
    wanted = name or usual or (next(iter(named)) if len(named) == 1 else None)
    if wanted not in named:
        asked = f"there is no data '{name}'" if name else "it has to be said which data is the field"
        raise InputError("fields.data_unknown", f"{asked}: the file has {', '.join(named)}", count=len(named))
    data = named[wanted]
    values = data.values
    finite = np.isfinite(values).all(axis=1)
    if data.where == "nodes" and not finite.all():
        count = int((~finite).sum())
        raise InputError("fields.not_finite", f"{count} of {len(values)} nodes have no finite value of '{wanted}'", count=count)
    if not finite.any():
        raise InputError("fields.not_finite", f"no element has a finite value of '{wanted}'", count=len(values))
    return data
