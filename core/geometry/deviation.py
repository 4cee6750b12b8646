"""How far two surfaces are apart, both ways: measured at every vertex and in the middle of every face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas
from core.mesh import Mesh

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class OneWay:
    """Distances in mm from a surface to another one: at its vertices (V,), in the middles of its faces (F,), areas (F,) mm²."""

    surface: Mesh
    at_vertices: Floats
    at_faces: Floats
    areas: Floats

    @property
    def maximum_mm(self) -> float:
        """The largest of all."""
        return float(max(self.at_vertices.max(), self.at_faces.max()))

    def farthest(self) -> Floats:
        """The place of the largest, (3,) mm."""
        vertex, face = int(np.argmax(self.at_vertices)), int(np.argmax(self.at_faces))
        if self.at_vertices[vertex] >= self.at_faces[face]:
            corner: Floats = self.surface.vertices[vertex]
            return corner
        place: Floats = self.surface.vertices[self.surface.faces[face]].mean(axis=0)
        return place

    def per_face(self) -> Floats:
        """The largest of corners and middle of each face, (F,): what a map paints."""
        worst: Floats = np.maximum(self.at_vertices[self.surface.faces].max(axis=1), self.at_faces)
        return worst

    def mean_square(self) -> Floats:
        """Mean of the squares over each face, (F,) mm², from corners (1/12 each) and middle (3/4): exact where the distance is
        linear over the face."""
        corners = self.at_vertices[self.surface.faces]
        squares: Floats = (corners**2).sum(axis=1) / 12.0 + 0.75 * self.at_faces**2
        return squares


@dataclass(frozen=True, eq=False, slots=True)
class Deviation:
    """forth: from the original to the result. back: from the result to the original."""

    forth: OneWay
    back: OneWay

    @property
    def maximum_mm(self) -> float:
        """Two-sided Hausdorff distance over the samples."""
        return max(self.forth.maximum_mm, self.back.maximum_mm)

    @property
    def rms_mm(self) -> float:
        """Root of the mean square over the area of both."""
        total = self.forth.areas.sum() + self.back.areas.sum()
        if total == 0.0:
            return self.maximum_mm
        squares = sum(float((way.mean_square() * way.areas).sum()) for way in (self.forth, self.back))
        return float(np.sqrt(squares / total))

    def farthest(self) -> Floats:
        """Where they are farthest apart, (3,) mm."""
        return (self.forth if self.forth.maximum_mm > self.back.maximum_mm else self.back).farthest()


def measure_deviation(original: Mesh, result: Mesh) -> Deviation:
    """Compare two surfaces of any connectivity; nothing is asked of their shape."""
    return Deviation(_one_way(original, result), _one_way(result, original))


def _one_way(surface: Mesh, other: Mesh) -> OneWay:
    tree = FaceTree.of(other.vertices, other.faces)
    at_vertices, _, _ = closest_points_in(tree, surface.vertices)
    at_faces, _, _ = closest_points_in(tree, surface.triangles().mean(axis=1))
    # vertices without faces are no part of the surface
    used = np.zeros(len(surface.vertices), dtype=np.bool_)
    used[surface.faces.ravel()] = True
    return OneWay(surface, np.where(used, at_vertices, 0.0), at_faces, face_areas(surface.vertices, surface.faces))
