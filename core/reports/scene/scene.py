"""Surfaces packed for the viewer in the report: whole numbers on a grid, along strips, deflated.

What the viewer's reader (web/src/mesh/scene.ts) undoes. One surface takes about 2 bytes per face.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.reports.palette import as_hex, tissue_colours
from core.reports.scene.face_order import neighbours_first, off_prediction, steps_back
from core.reports.scene.thin_out import thin_out

FORMAT_VERSION = 2
GRID_BITS = 18  # of the longest side: 0.007 mm for a body 1.8 m tall
MOST_FACES = 1_000_000  # of all surfaces together; browsers stay fluent, and a mail stays small
FLAT_MM = 1e-9  # so that flat surfaces, too, are told apart by their other two extents
DEFLATE_EFFORT = 6
NO_DEPTHS: Mapping[str, NDArray[np.float64]] = {}
PLANES = (0, 8, 16)  # the bytes of a number lie apart: high ones are nearly all 0
DEPTH_STEPS = 254  # from 0 to the deepest, told as bytes 1 to 255; byte 0 is a vertex that has no depth


@dataclass(frozen=True, slots=True)
class Painted:
    """What the numbers are that surfaces are painted by, if not depths; `shown`: from the start."""

    name: str
    unit: str
    shown: bool = True


@dataclass(frozen=True, slots=True)
class Scene:
    """`about` as JSON and `data` deflated: what `web/src/mesh/scene.ts` reads.

    error_mm: no vertex shown is farther than this from where it is. thinned: names of surfaces shown by a coarser one.
    """

    about: dict[str, Any]
    data: bytes
    error_mm: float
    thinned: tuple[str, ...]


def make_scene(
    meshes: Mapping[str, Mesh],
    depths_mm: Mapping[str, NDArray[np.float64]] = NO_DEPTHS,
    most_faces: int = MOST_FACES,
    painted: Painted | None = None,
) -> Scene | None:
    """Pack surfaces, the largest first, as they are drawn; None if there are none.

    depths_mm: surface -> distance of its vertices (V,) or faces (F,) to the skin, NaN where there is none, painted on it on
    demand; or whatever `painted` calls it.
    Promises: same meshes, same bytes; every face keeps its corners and its orientation unless its surface is thinned; that
              has no depths either. A depth is shown to a 254th of the largest, NaN as grey.
    """
    largest_first = sorted(meshes.items(), key=lambda item: -float(np.prod(item[1].extents_mm() + FLAT_MM)))
    if not meshes:
        return None
    shown = dict(largest_first)
    allowed = most_faces / sum(len(mesh.faces) for mesh in shown.values())
    drawn = {name: thin_out(mesh, int(allowed * len(mesh.faces))) if allowed < 1 else mesh for name, mesh in shown.items()}
    low = np.min([mesh.vertices.min(axis=0) for mesh in drawn.values()], axis=0)
    high = np.max([mesh.vertices.max(axis=0) for mesh in drawn.values()], axis=0)
    step = float((high - low).max()) / (2**GRID_BITS - 1) or 1.0
    colours = tissue_colours(list(meshes))
    surfaces: list[dict[str, Any]] = []
    chunks: list[bytes] = []
    for name, mesh in drawn.items():
        faces, order = neighbours_first(mesh.faces, len(mesh.vertices))
        grid = np.rint((mesh.vertices[order] - low) / step).astype(np.int64)
        off = off_prediction(faces, grid)
        chunks += _planes(steps_back(faces)) + _planes(np.where(off >= 0, 2 * off, -2 * off - 1).astype(np.uint32))
        surfaces.append(
            {
                "name": name,
                "colour": as_hex(colours[name]),
                "vertices": len(order),
                "faces": len(faces),
                "of_faces": len(meshes[name].faces),
                "closed": _is_closed(mesh),
                "deepest_mm": None,
            }
        )
        if name in depths_mm and mesh is meshes[name]:
            depths = _of_vertices(depths_mm[name], mesh)[order]
            surfaces[-1]["deepest_mm"] = deepest = float(np.max(depths, initial=0.0, where=np.isfinite(depths))) or 1.0
            steps = 1.0 + np.rint(DEPTH_STEPS / deepest * np.maximum(depths, 0.0))
            chunks.append(np.nan_to_num(steps).astype(np.uint8).tobytes())
    about: dict[str, Any] = {"version": FORMAT_VERSION, "origin_mm": low.tolist(), "step_mm": step, "surfaces": surfaces}
    if painted is not None:
        about["painted"] = asdict(painted)
    thinned = tuple(name for name in drawn if drawn[name] is not meshes[name])
    return Scene(about, zlib.compress(b"".join(chunks), DEFLATE_EFFORT), 0.5 * float(np.sqrt(3.0)) * step, thinned)


def _planes(numbers: NDArray[np.uint32]) -> list[bytes]:
    """(N, 3) as 3 x 3 runs of N bytes: column by column, low bytes before high ones."""
    return [(numbers[:, column] >> shift & 255).astype(np.uint8).tobytes() for column in range(3) for shift in PLANES]


def _of_vertices(depths_mm: NDArray[np.float64], mesh: Mesh) -> NDArray[np.float64]:
    """(V,): as given, or the mean of the faces around that have one, NaN if none has."""
    if len(depths_mm) == len(mesh.vertices):
        return depths_mm
    known = np.isfinite(depths_mm)
    corners = mesh.faces[known].ravel()
    sums = np.bincount(corners, np.repeat(depths_mm[known], 3), minlength=len(mesh.vertices))
    counts = np.bincount(corners, minlength=len(mesh.vertices))
    means: NDArray[np.float64] = np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)
    return means


def _is_closed(mesh: Mesh) -> bool:
    """Every directed edge has exactly one that runs the other way: only then is the inside of a section known."""
    starts = mesh.faces.astype(np.int64)
    ends = np.roll(starts, -1, axis=1)
    there = np.sort((starts * len(mesh.vertices) + ends).ravel())
    back = np.sort((ends * len(mesh.vertices) + starts).ravel())
    return bool(np.array_equal(there, back) and (np.diff(there) > 0).all())
