"""Faces at an edge with more than two of them, sorted into pairs that bound one body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges, edges
from core.geometry.components import label_connected
from core.geometry.volume import signed_volumes
from core.healing.change import Change, Staged
from core.healing.fan_splitting import split_fans
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDS = 8  # a face is bent at one of its edges at a time
PULL = 0.02  # of the way to the faces' tips: how far the middle of an edge is drawn off it


def part_edges(vertices: Vertices, faces: Faces) -> Staged:
    """Part the surface at edges with more than two faces, two by two. An odd face out gets a border."""
    changes: list[Change] = []
    for _ in range(ROUNDS):
        found = edges(faces)
        if not (found.face_count > 2).any():
            break
        ends = np.unique(found.ends[found.face_count > 2])
        what = "vertices of edges with more than two faces were parted"
        vertices, faces, split = split_fans(vertices, faces, _paired_fans(vertices, faces, found), "shared_edges", what, ends)
        vertices, faces, bent = _bend_edges(vertices, faces)
        changes += split + bent
        faces, odd = _without_odd_faces(vertices, faces)
        changes += odd
    return vertices, faces, changes


def _without_odd_faces(vertices: Vertices, faces: Faces) -> tuple[Faces, list[Change]]:
    """Faces that have no partner at an edge which others share, and could not be parted from it, leave a hole."""
    found = edges(faces)
    crowded = found.face_count > 2
    if not crowded.any():
        return faces, []
    at_crowded = np.flatnonzero(crowded[found.of_face.ravel()])
    odd = np.unique(np.setdiff1d(at_crowded, _pairs_at_crowded_edges(vertices, faces, found)) // 3)
    if len(odd) == 0:
        return faces, []
    triangles = vertices[faces[odd]]
    points = triangles.mean(axis=1)
    message = f"{len(odd)} faces without a partner at an edge that others share were taken out"
    return np.delete(faces, odd, axis=0), [Change("odd_faces", message, points, np.zeros(len(points)), taken=triangles)]


def _paired_fans(vertices: Vertices, faces: Faces, found: Edges) -> Ints:
    """Fans (F, 3) as `borders.fans` has them, that also walk over crowded edges from a face to its partner."""
    _edge, face, side = found.two_faces()
    extra = _pairs_at_crowded_edges(vertices, faces, found)
    first = np.concatenate(((3 * face + side)[:, 0], extra[:, 0]))
    second = np.concatenate(((3 * face + side)[:, 1], extra[:, 1]))
    next_first, next_second = (at - at % 3 + (at % 3 + 1) % 3 for at in (first, second))
    forward = found.forward.ravel()
    same_way = forward[first] == forward[second]
    _count, fan = label_connected(
        faces.size,
        np.concatenate((first, next_first)),
        np.concatenate((np.where(same_way, second, next_second), np.where(same_way, next_second, second))),
    )
    return fan.reshape(-1, 3)


def _pairs_at_crowded_edges(vertices: Vertices, faces: Faces, found: Edges) -> Ints:
    """Sides (3 face + side) that belong together, (K, 2), by edge: of one sheet if just two of it meet there, else by angle."""
    crowded = found.face_count > 2
    _edge, both, _side = found.two_faces()
    _count, sheet = label_connected(len(faces), both[:, 0], both[:, 1])
    inverted = signed_volumes(vertices, faces, np.zeros(len(faces), dtype=np.int64))[0] < 0.0
    row, side = np.nonzero(crowded[found.of_face])
    edge = found.of_face[row, side]
    order = np.argsort(edge, kind="stable")
    pairs: list[tuple[int, int]] = []
    for members in np.split(order, np.flatnonzero(np.diff(edge[order])) + 1):
        numbers, times = np.unique(sheet[row[members]], return_counts=True)
        for number in numbers[times == 2]:
            i, j = members[sheet[row[members]] == number]
            pairs.append((int(3 * row[i] + side[i]), int(3 * row[j] + side[j])))
        members = members[np.isin(sheet[row[members]], numbers[times != 2])]
        if len(members) < 2:
            continue
        halves = 3 * row[members] + side[members]
        tips = vertices[faces[row[members], (side[members] + 2) % 3]]
        low, high = vertices[found.ends[edge[members[0]]]]
        angle = _angles_around(low, high, tips)
        forward = found.forward[row[members], side[members]] != inverted
        pairs += [(int(halves[i]), int(halves[j])) for i, j in pair_faces(angle, forward)]
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _angles_around(low: Floats, high: Floats, tips: Floats) -> Floats:
    """Angle of each tip (N, 3) about the axis from low to high (3,), radians, counted from the first tip."""
    axis = (high - low) / np.linalg.norm(high - low)
    arms = tips - low
    arms = arms - (arms @ axis)[:, None] * axis
    angle: Floats = np.mod(np.arctan2(arms @ np.cross(axis, arms[0]), arms @ arms[0]), 2.0 * np.pi)
    return angle


def pair_faces(angle: Floats, forward: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Which faces around an edge bound a body together: (i, j) numbers, each at most once.

    angle: (N,) about the edge. forward: (N,) whether the face runs along the edge's axis; its body then lies on the side
    of smaller angles. Neighbours with the body between them are paired first, then whatever is next to each other,
    narrow wedges first.
    """
    order = np.argsort(angle, kind="stable").tolist()
    pairs: list[tuple[int, int]] = []
    for needs_body in (True, False):
        wedges = []
        for place, i in enumerate(order):
            j = order[(place + 1) % len(order)]
            if i != j and (not needs_body or (not forward[i] and forward[j])):
                wedges.append((float(np.mod(angle[j] - angle[i], 2.0 * np.pi)), i, j))
        for _width, i, j in sorted(wedges):
            if i in order and j in order:
                pairs.append((i, j))
                order = [k for k in order if k not in (i, j)]
    while len(order) >= 2:
        pairs.append((order[0], order[1]))
        order = order[2:]
    return pairs


def _bend_edges(vertices: Vertices, faces: Faces) -> Staged:
    """Edges whose ends could not be parted, since faces hang together around them: all pairs but one get a vertex more."""
    found = edges(faces)
    if not (found.face_count > 2).any():
        return vertices, faces, []
    halves = _pairs_at_crowded_edges(vertices, faces, found)
    edge = found.of_face.ravel()[halves[:, 0]]
    later = np.append(False, edge[1:] == edge[:-1])
    faces = faces.copy()
    points: list[Floats] = []
    places: list[Floats] = []
    parts: list[tuple[int, int, int]] = []
    busy: set[int] = set()
    for pair in halves[later].tolist():
        rows = [half // 3 for half in pair]
        if busy & set(rows):
            continue  # its other edge comes in the next round
        busy |= set(rows)
        ends = vertices[found.ends[found.of_face.ravel()[pair[0]]]]
        tips = vertices[[faces[half // 3, (half % 3 + 2) % 3] for half in pair]]
        middle = ends.mean(axis=0)
        points.append(middle)
        new = len(vertices) + len(places)
        places.append(middle + PULL * (tips.mean(axis=0) - middle))
        for half in pair:
            a, b, c = (int(faces[half // 3, (half % 3 + turn) % 3]) for turn in range(3))
            faces[half // 3] = (a, new, c)
            parts.append((new, b, c))
    if not places:
        return vertices, faces, []
    new_places = np.array(places).astype(np.float32).astype(np.float64)
    distances = np.linalg.norm(new_places - np.array(points), axis=1)
    message = f"{len(places)} edges with more than two faces were bent apart, up to {distances.max():.3g} mm"
    change = Change("shared_edges", message, np.array(points), distances)
    faces = np.concatenate((faces, np.array(parts, dtype=np.int32)))
    return np.concatenate((vertices, new_places)), faces, [change]
