"""From a surface to its numbers in the report."""

from __future__ import annotations

import numpy as np

from core.geometry.normals import face_areas
from core.geometry.orientation import find_faces_to_flip
from core.schema.report import EdgeNumbers, MeshReport, QualityNumbers
from core.validation.surface import Surface

DIGITS = 9  # enough for float32 coordinates, and the same whichever way a processor adds up


def significant(value: float) -> float:
    """Rounded to `DIGITS` significant digits, so that equal jobs give equal reports on unequal processors."""
    return float(f"{value:.{DIGITS}g}")


def measure_surface(surface: Surface) -> MeshReport:
    """All numbers of one mesh."""
    mesh = surface.mesh
    edge_ends = surface.edges.ends
    lengths = np.linalg.norm(mesh.vertices[edge_ends[:, 0]] - mesh.vertices[edge_ends[:, 1]], axis=1)
    if len(lengths) == 0:
        lengths = np.zeros(1)  # no face is more than a line or a point
    x, y, z = (significant(float(extent)) for extent in mesh.extents_mm())
    degrees = surface.dihedral[2]
    return MeshReport(
        vertices=len(mesh.vertices),
        faces=len(mesh.faces),
        components=surface.component_count,
        euler_characteristic=_euler_characteristic(surface),
        genus=_genus(surface),
        closed=surface.closed,
        edge_manifold=surface.edge_manifold,
        vertex_manifold=surface.manifold,
        consistently_oriented=surface.consistent,
        oriented_outward=None if surface.inside_out is None else len(surface.inside_out) == 0,
        degenerate_faces=len(surface.degenerate),
        duplicate_faces=len(surface.duplicates),
        self_intersecting_pairs=len(surface.intersecting),
        area_mm2=significant(float(face_areas(mesh.vertices, mesh.faces).sum())),
        volume_mm3=significant(float(surface.component_volumes.sum())) if surface.closed and surface.consistent else None,
        extents_mm=(x, y, z),
        quality=_quality_numbers(surface),
        edges=EdgeNumbers(
            minimum_mm=significant(float(lengths.min())),
            median_mm=significant(float(np.median(lengths))),
            maximum_mm=significant(float(lengths.max())),
        ),
        minimum_dihedral_deg=significant(float(degrees.min())) if len(degrees) else None,
    )


def _quality_numbers(surface: Surface) -> QualityNumbers:
    percentile_1, median = np.percentile(surface.quality, [1, 50])
    return QualityNumbers(
        minimum=significant(float(surface.quality.min())),
        percentile_1=significant(float(percentile_1)),
        median=significant(float(median)),
        mean=significant(float(surface.quality.mean())),
    )


def _euler_characteristic(surface: Surface) -> int:
    """V - E + F over the vertices that faces use and the faces that are triangles."""
    return len(np.unique(surface.proper)) - len(surface.edges.ends) + len(surface.proper)


def _genus(surface: Surface) -> int | None:
    """Sum of 1 - χ/2 over the pieces; None unless closed, manifold and two-sided."""
    if not (surface.closed and surface.manifold):
        return None
    if not surface.consistent and find_faces_to_flip(surface.edges) is None:
        return None
    return surface.component_count - _euler_characteristic(surface) // 2
