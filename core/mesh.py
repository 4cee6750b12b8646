"""The one mesh type: triangles in millimetres, frozen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import InputError

Vertices: TypeAlias = NDArray[np.float64]
Faces: TypeAlias = NDArray[np.int32]

LARGEST_COORDINATE_MM = 1e7  # 10 km: beyond it float32 files cannot hold a human detail


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Triangles in space; arrays are read-only, so a mesh can be shared between threads and steps.

    vertices: (V, 3) float64 in mm. faces: (F, 3) int32, 0-based, counter-clockwise seen from outside.
    Finite coordinates and valid indices are promised; closedness, manifoldness and the rest are `core.validation`'s.
    """

    vertices: Vertices
    faces: Faces

    @classmethod
    def of(cls, vertices: ArrayLike, faces: ArrayLike) -> Mesh:
        """Copy, check and freeze arrays.

        Raises: InputError `mesh.empty`, `mesh.shape`, `mesh.not_finite`, `mesh.coordinate_out_of_range`,
        `mesh.index_out_of_range`, each with the count and the first offender.
        """
        points = np.array(vertices, dtype=np.float64, order="C")
        triangles = np.asarray(faces)
        if points.size == 0 or triangles.size == 0:
            raise InputError("mesh.empty", f"the mesh has {len(points)} vertices and {len(triangles)} faces")
        if points.ndim != 2 or points.shape[1] != 3 or triangles.ndim != 2 or triangles.shape[1] != 3:
            raise InputError(
                "mesh.shape", f"vertices have shape {points.shape} and faces {triangles.shape}; (V, 3) and (F, 3) wanted"
            )
        _require_finite(points)
        _require_indices(triangles, len(points))
        return cls._freeze(points, triangles.astype(np.int32, order="C"))

    @classmethod
    def _freeze(cls, points: Vertices, triangles: Faces) -> Mesh:
        points.setflags(write=False)
        triangles.setflags(write=False)
        return cls(points, triangles)

    def with_vertices(self, vertices: ArrayLike) -> Mesh:
        """Same connectivity, other places; (V, 3) mm."""
        moved = np.array(vertices, dtype=np.float64, order="C")
        if moved.shape != self.vertices.shape:
            raise ValueError(f"shape {moved.shape} does not fit {self.vertices.shape}")
        _require_finite(moved)
        return Mesh._freeze(moved, self.faces)

    def rounded_to_float32(self) -> Mesh:
        """The mesh a binary STL will hold; prove this one, not its float64 parent."""
        return self.with_vertices(self.vertices.astype(np.float32))

    def triangles(self) -> NDArray[np.float64]:
        """Corner coordinates, (F, 3, 3) mm."""
        return self.vertices[self.faces]

    def extents_mm(self) -> NDArray[np.float64]:
        """Size of the bounding box, (3,) mm."""
        size: NDArray[np.float64] = np.ptp(self.vertices, axis=0)
        return size


def _require_finite(points: Vertices) -> None:
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        first = int(np.flatnonzero(bad)[0])
        raise InputError(
            "mesh.not_finite",
            f"{int(bad.sum())} of {len(points)} vertices are NaN or infinite, the first is number {first}",
            count=int(bad.sum()),
            first_vertex=first,
        )
    far = np.abs(points).max()
    if far > LARGEST_COORDINATE_MM:
        raise InputError(
            "mesh.coordinate_out_of_range",
            f"a coordinate of {far:g} mm is beyond the limit of {LARGEST_COORDINATE_MM:g} mm",
            largest_mm=float(far),
        )


def _require_indices(triangles: NDArray[np.integer], vertex_count: int) -> None:
    low, high = int(triangles.min()), int(triangles.max())
    if low < 0 or high >= vertex_count:
        raise InputError(
            "mesh.index_out_of_range",
            f"face indices run from {low} to {high} (0-based); {vertex_count} vertices allow 0 to {vertex_count - 1}",
            lowest=low,
            highest=high,
            vertices=vertex_count,
        )
