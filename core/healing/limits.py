"""Whether more of the surface would change than may."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.coincidence import position_ids
from core.geometry.containment import is_inside
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas
from core.healing.change import Change
from core.mesh import Faces, Mesh, Vertices
from core.schema.heal import HealParameters
from core.validation.measure import significant

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Triangles = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Extent:
    """How much changed. Shares are of the area and the volume of the surface as it was.

    lost_mm: from what was there to what is; gained_mm: the other way round. What was taken away or added on purpose has its
    area counted instead.
    """

    faces_kept: int
    area_taken: float
    area_added: float
    volume_change: float
    lost_mm: float
    gained_mm: float


def find_former(before: Mesh, after: Mesh) -> Ints:
    """For each face of `after` the face of `before` with its corners at the same places, or -1; (F,)."""
    place = position_ids(np.concatenate((before.vertices, after.vertices)))
    corners = np.concatenate((place[before.faces], place[after.faces + np.int32(len(before.vertices))]))
    corners = np.sort(corners, axis=1)
    order = np.lexsort((corners[:, 2], corners[:, 1], corners[:, 0]))
    starts = np.append(True, (corners[order][1:] != corners[order][:-1]).any(axis=1))
    first = np.empty(len(order), dtype=np.int64)
    first[order] = order[starts][np.cumsum(starts) - 1]  # stable: faces of `before` come first
    of_after = first[len(before.faces) :]
    return np.where(of_after < len(before.faces), of_after, -1)


def measure_extent(before: Mesh, after: Mesh, former: Ints, changes: list[Change], volumes: tuple[float, float, float]) -> Extent:
    """Compare; volumes: lowest and highest that the surface may have had, and what it has, mm³."""
    taken = np.concatenate([np.empty((0, 3, 3)), *(change.taken for change in changes)])
    added = np.concatenate([np.empty((0, 3, 3)), *(change.added for change in changes)])
    area = float(face_areas(after.vertices, after.faces).sum()) - _area(added) + _area(taken)
    low, high, now = volumes
    off = max(low - now, now - high, 0.0)
    kept = np.zeros(len(before.faces), dtype=np.bool_)
    kept[former[former >= 0]] = True
    lost, gained = before.triangles()[~kept], after.triangles()[former < 0]
    lost_mm = _farthest(lost, _together(after, taken), after)
    gained_mm = _farthest(gained, _together(before, added), None)
    return Extent(
        int((former >= 0).sum()),
        _area(taken) / max(area, 1e-300),
        _area(added) / max(area, 1e-300),
        off / max(high, 1e-300),
        lost_mm,
        gained_mm,
    )


def require_within(extent: Extent, inputs: HealParameters) -> None:
    """Raises: InputError `heal.changes_too_much`."""
    checks = (
        ("area taken away", extent.area_taken, inputs.max_area_change, "max_area_change", ""),
        ("area added", extent.area_added, inputs.max_area_change, "max_area_change", ""),
        ("change of the volume", extent.volume_change, inputs.max_volume_change, "max_volume_change", ""),
        ("deviation", max(extent.lost_mm, extent.gained_mm), inputs.max_deviation_mm, "max_deviation_mm", " mm"),
    )
    broken = [(what, value, limit, name, unit) for what, value, limit, name, unit in checks if value > limit]
    if broken:
        told = "; ".join(
            f"{what} {value:.4g}{unit}, allowed are {limit:g}{unit} (`{name}`)" for what, value, limit, name, unit in broken
        )
        raise InputError(
            "heal.changes_too_much",
            f"healing would change the surface more than allowed: {told}",
            area_taken=significant(extent.area_taken),
            area_added=significant(extent.area_added),
            volume_change=significant(extent.volume_change),
            deviation_mm=significant(max(extent.lost_mm, extent.gained_mm)),
        )


def _area(triangles: Triangles) -> float:
    crosses = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return float(np.linalg.norm(crosses, axis=1).sum() / 2)


def _together(mesh: Mesh, triangles: Triangles) -> FaceTree:
    """Boxes over a mesh and some more triangles."""
    more: Faces = (len(mesh.vertices) + np.arange(3 * len(triangles))).reshape(-1, 3).astype(np.int32)
    vertices: Vertices = np.concatenate((mesh.vertices, triangles.reshape(-1, 3)))
    return FaceTree.of(vertices, np.concatenate((mesh.faces, more)))


def _farthest(triangles: Triangles, tree: FaceTree, result: Mesh | None) -> float:
    """Largest distance of corners and middles from the tree, mm; what lies inside the result is swallowed, not lost."""
    if len(triangles) == 0:
        return 0.0
    points = np.concatenate((np.unique(triangles.reshape(-1, 3), axis=0), triangles.mean(axis=1)))
    distance = closest_points_in(tree, points)[0]
    if result is not None and distance.max() > 0.0:
        asked = np.flatnonzero(distance > 0.0)
        inside = is_inside(FaceTree.of(result.vertices, result.faces), points[asked])
        distance[asked[inside]] = 0.0
    return float(distance.max())
