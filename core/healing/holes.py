"""Holes are filled so that the surface goes on as it is around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.errors import InputError
from core.geometry.adjacency import Edges, edges
from core.geometry.components import face_components
from core.geometry.degenerate import find_degenerate_faces
from core.healing.borders import border_sides, find_loops
from core.healing.bridging import join_rims
from core.healing.change import Change, Staged
from core.healing.fairing import fair, spread
from core.healing.local_crossings import find_crossings_of
from core.healing.loop_triangulation import triangulate_loop
from core.healing.patch_refinement import flip_to_delaunay, refine
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

REFINED, STRETCHED, BARE = range(3)  # ways to fill a hole, from the best to the safest
FINENESS = 0.85  # of the length of the edges of the rim: a hole of one missing vertex gets one again, one of two faces none
FAIRINGS = 3  # a bulge is larger than the membrane it grew from, so faces are refined again


@dataclass(frozen=True, eq=False, slots=True)
class _Patches:
    """Faces over all holes; numbers from `count` on are new points. patch: (F,), owner: (N,) the patch of each new point."""

    faces: Faces
    patch: Ints
    new: Floats
    owner: Ints


def fill_holes(vertices: Vertices, faces: Faces, allowed: bool = True, max_hole_mm: float | None = None) -> Staged:
    """Close every border with a patch as fine and as curved as its surroundings.

    Needs edges with at most two faces and consistent orientation. Rims of different pieces may share a patch: a ring.
    Where a patch would run through the surface, it is stretched flat, then left without new vertices.
    Raises: InputError `heal.holes_not_allowed`, `heal.hole_too_large`.
    """
    loops = [loop for loop in find_loops(faces) if len(loop) > 2]
    if not loops:
        return vertices, faces, []
    _require_allowed(vertices, loops, allowed, max_hole_mm)
    piece = face_components(edges(faces))[1]
    gaps = join_rims(vertices, faces, loops, piece)
    changes = []
    if len(gaps.turned):
        turned = np.isin(piece, gaps.turned)
        faces = np.where(turned[:, None], faces[:, [0, 2, 1]], faces)
        message = f"{int(turned.sum())} faces of pieces were turned over to look as the piece they were joined to"
        points = vertices[faces[turned]].mean(axis=1)
        changes.append(Change("turned_faces", message, points, np.zeros(len(points))))
    bare = _cover(vertices, faces, gaps.rims)
    patches, stretched = _shape(vertices, faces, bare)
    new, added, patch = _choose(vertices, faces, bare, patches, stretched, len(gaps.rims))
    places = np.concatenate((vertices, new))
    points = np.array([vertices[rim].mean(axis=0) for rim in gaps.rims])
    distances = _reach(vertices, places, np.unique(np.concatenate(gaps.rims)), added, patch, len(points))
    longest = max(len(rim) for rim in gaps.rims)
    message = f"{len(points)} holes, rims of up to {longest} vertices, were filled with {len(added)} faces"
    change = Change("holes", message, points, distances, added=places[added])
    return places, np.concatenate((faces, added)), [*changes, change]


def _require_allowed(vertices: Vertices, loops: list[Ints], allowed: bool, max_hole_mm: float | None) -> None:
    lengths = [float(np.linalg.norm(np.diff(vertices[loop], axis=0, append=vertices[loop[:1]]), axis=1).sum()) for loop in loops]
    longest = max(lengths)
    if not allowed:
        raise InputError(
            "heal.holes_not_allowed",
            f"{len(loops)} holes are left, the longest rim is {longest:.4g} mm, and `fill_holes` is false",
            holes=len(loops),
            longest_mm=longest,
        )
    if max_hole_mm is not None and longest > max_hole_mm:
        raise InputError(
            "heal.hole_too_large",
            f"the rim of a hole is {longest:.4g} mm long, more than the {max_hole_mm:g} mm of `max_hole_mm`",
            longest_mm=longest,
            limit_mm=max_hole_mm,
        )


def _cover(vertices: Vertices, faces: Faces, rims: list[Ints]) -> _Patches:
    """Each rim covered without new points."""
    found = edges(faces)
    stride = len(vertices)
    keys = found.ends[:, 0] * stride + found.ends[:, 1]
    face, side = border_sides(found)
    beyond = faces[face, (side + 1) % 3].astype(np.int64) * stride + faces[face, side]
    order = np.argsort(beyond)
    beyond, tips = beyond[order], faces[face, (side + 2) % 3][order]
    parts, owners = [], []
    added = np.empty(0, dtype=np.int64)
    for number, rim in enumerate(rims):
        if len(rim) == 3:
            parts.append(rim[None])
            owners.append(np.full(1, number))
            continue
        following = np.roll(rim, -1)
        at = np.minimum(np.searchsorted(beyond, rim * stride + following), len(beyond) - 1)
        outer = vertices[tips[at]]
        outer[beyond[at] != rim * stride + following] = np.nan  # a bridge
        low, high = np.minimum.outer(rim, rim), np.maximum.outer(rim, rim)
        chords = low * stride + high
        taken = (keys[np.minimum(np.searchsorted(keys, chords), len(keys) - 1)] == chords) | (low == high)
        bridge = np.isnan(outer[:, 0])
        taken |= np.isin(
            chords, np.concatenate((added, chords[np.arange(len(rim)), (np.arange(len(rim)) + 1) % len(rim)][bridge]))
        )
        triangles = rim[triangulate_loop(vertices[rim], outer, taken)]
        parts.append(triangles)
        owners.append(np.full(len(triangles), number))
        sides = np.concatenate((triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]))
        added = np.concatenate((added, sides.min(axis=1) * stride + sides.max(axis=1)))
    covered = np.concatenate(parts).astype(np.int32)
    return _Patches(covered, np.concatenate(owners), np.empty((0, 3)), np.empty(0, dtype=np.int64))


def _shape(vertices: Vertices, faces: Faces, bare: _Patches) -> tuple[_Patches, Floats]:
    """The patches refined and bent, and where their new points lie if they are only stretched."""
    at_rim = np.zeros(len(vertices), dtype=np.bool_)
    at_rim[bare.faces] = True
    around = faces[at_rim[faces].any(axis=1)]
    used, corners = np.unique(np.concatenate((around, bare.faces)), return_inverse=True)
    local: Faces = corners.reshape(-1, 3).astype(np.int32)
    ring, patches, patch = local[: len(around)], local[len(around) :], bare.patch
    points: Floats = vertices[used]
    old = len(points)
    outside = edges(ring)
    size, taken = _sizes(points, edges(patches)), outside.ends
    for fairing in range(FAIRINGS):
        points, patches, patch, size = refine(points, patches, patch, size, taken)
        free = np.arange(len(points)) >= old
        if fairing == 0:
            points = spread(points, patches, free)
            patches = flip_to_delaunay(points, patches, taken)
        everything = np.concatenate((ring, patches))
        points = fair(points, everything, free, order=2)
        patches = flip_to_delaunay(points, patches, taken)
    stretched = fair(points, everything, free, order=1)
    bent = fair(points, np.concatenate((ring, patches)), free, order=2)
    number = np.concatenate((used, len(vertices) + np.arange(len(points) - old)))
    owner = np.zeros(len(points), dtype=np.int64)
    owner[patches] = patch[:, None]
    made = _Patches(number[patches].astype(np.int32), patch, _rounded(bent[old:]), owner[old:])
    return made, _rounded(stretched[old:])


def _rounded(points: Floats) -> Floats:
    return points.astype(np.float32).astype(np.float64)


def _sizes(points: Floats, found: Edges) -> Floats:
    """Length wanted of edges at each point of the rims, (P,) mm; 0 at other points."""
    ends = found.ends[found.face_count == 1]
    lengths = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    count = np.bincount(ends.ravel(), minlength=len(points))
    sizes: Floats = np.bincount(ends.ravel(), np.repeat(FINENESS * lengths, 2), minlength=len(points)) / np.maximum(count, 1)
    return sizes


def _choose(
    vertices: Vertices, faces: Faces, bare: _Patches, shaped: _Patches, stretched: Floats, count: int
) -> tuple[Floats, Faces, Ints]:
    """For each patch the best way to fill it that runs through nothing: new points, faces, patch of each face."""
    way = np.full(count, REFINED)
    for last in (STRETCHED, BARE, None):
        new = np.where((way[shaped.owner] == STRETCHED)[:, None], stretched, shaped.new)
        refined, plain = way[shaped.patch] < BARE, way[bare.patch] == BARE
        added = np.concatenate((shaped.faces[refined], bare.faces[plain]))
        patch = np.concatenate((shaped.patch[refined], bare.patch[plain]))
        if last is None:
            break
        places, together = np.concatenate((vertices, new)), np.concatenate((faces, added))
        chosen = np.arange(len(faces), len(together))
        bad = np.concatenate((find_crossings_of(places, together, chosen).ravel(), find_degenerate_faces(places, together)))
        guilty = np.unique(patch[bad[bad >= len(faces)] - len(faces)])
        if len(guilty) == 0:
            break
        way[guilty] = np.minimum(way[guilty] + 1, last)
    kept, number = np.unique(added[added >= len(vertices)], return_inverse=True)
    added = added.copy()
    added[added >= len(vertices)] = len(vertices) + number
    return new[kept - len(vertices)], added, patch


def _reach(vertices: Vertices, places: Floats, rim: Ints, added: Faces, patch: Ints, count: int) -> Floats:
    """How far the middles of each patch's faces lie from the rims at most, (count,) mm."""
    way = cKDTree(vertices[rim]).query(places[added].mean(axis=1))[0]
    reach = np.zeros(count)
    np.maximum.at(reach, patch, way)
    return reach
