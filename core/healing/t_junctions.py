"""T-junctions: a vertex of one border on a side of another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.adjacency import Edges, edges
from core.healing.borders import border_sides
from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHARE = 0.03  # of the side's length: a vertex nearer to it lies on it. A triangle between them would be a sliver
END_SHARE = 1e-6  # of the side's length: a vertex nearer to its end is none of its inside
ROUNDS = 24  # a face has three sides, and its parts may be met again


def split_sides_at_vertices(vertices: Vertices, faces: Faces) -> Staged:
    """Split border sides at the border vertices that lie on them, so that both sides of the seam have the same vertices."""
    points: list[Floats] = []
    distances: list[Floats] = []
    for _ in range(ROUNDS):
        face, side, vertex, along, distance = _find_hits(vertices, faces)
        if len(face) == 0:
            break
        # one side of a face at a time
        chosen = np.isin(3 * face + side, 3 * np.unique(face) + side[np.unique(face, return_index=True)[1]])
        faces = _split(faces, face[chosen], side[chosen], vertex[chosen], along[chosen])
        points.append(vertices[vertex[chosen]])
        distances.append(distance[chosen])
    if not points:
        return vertices, faces, []
    where, how_far = np.concatenate(points), np.concatenate(distances)
    message = f"sides of faces were split at {len(where)} vertices on them, up to {how_far.max():.3g} mm off"
    return vertices, faces, [Change("t_junctions", message, where, how_far)]


def _find_hits(vertices: Vertices, faces: Faces) -> tuple[Ints, Ints, Ints, Floats, Floats]:
    """Border vertices on border sides: face, side, vertex, place along the side (0..1), distance mm; all (K,), by side."""
    found = edges(faces)
    face, side = border_sides(found)
    none = np.empty(0, dtype=np.int64)
    if len(face) == 0:
        return none, none, none, np.empty(0), np.empty(0)
    start, end, apex = (faces[face, (side + turn) % 3].astype(np.int64) for turn in range(3))
    border = np.unique(np.concatenate((start, end)))
    length = np.linalg.norm(vertices[end] - vertices[start], axis=1)
    lists = cKDTree(vertices[border]).query_ball_point(
        (vertices[start] + vertices[end]) / 2, length * (0.5 + SHARE), return_sorted=True
    )
    count = np.array([len(some) for some in lists])
    row = np.repeat(np.arange(len(face)), count)
    vertex = border[np.concatenate([np.asarray(some, dtype=np.int64) for some in lists])]
    strange = (vertex != start[row]) & (vertex != end[row]) & (vertex != apex[row])
    row, vertex = row[strange], vertex[strange]
    inner_face, inner_side, inner_vertex = _inner_sides(found, np.column_stack((start, end)))
    row = np.concatenate((row, len(face) + np.arange(len(inner_face))))
    vertex = np.concatenate((vertex, inner_vertex))
    face, side = np.concatenate((face, inner_face)), np.concatenate((side, inner_side))
    start, end = (faces[face, (side + turn) % 3].astype(np.int64) for turn in range(2))
    length = np.linalg.norm(vertices[end] - vertices[start], axis=1)
    direction, offset = vertices[end[row]] - vertices[start[row]], vertices[vertex] - vertices[start[row]]
    along = np.einsum("ij,ij->i", direction, offset) / length[row] ** 2
    distance = np.linalg.norm(offset - along[:, None] * direction, axis=1)
    on_it = (distance <= SHARE * length[row]) & (along > END_SHARE) & (along < 1.0 - END_SHARE)
    row, vertex, along, distance = row[on_it], vertex[on_it], along[on_it], distance[on_it]
    # new sides must not run along an edge that has its two faces
    stride = len(vertices)
    full = found.face_count >= 2
    keys = found.ends[full, 0] * stride + found.ends[full, 1]
    clear = np.ones(len(row), dtype=np.bool_)
    for other in (start[row], end[row]):
        clear &= ~np.isin(np.minimum(vertex, other) * stride + np.maximum(vertex, other), keys)
    row, vertex, along, distance = row[clear], vertex[clear], along[clear], distance[clear]
    order = np.lexsort((along, side[row], face[row]))
    row, vertex, along, distance = row[order], vertex[order], along[order], distance[order]
    return face[row], side[row], vertex, along, distance


def _inner_sides(found: Edges, border: Ints) -> tuple[Ints, Ints, Ints]:
    """Sides at edges with two faces whose ends are the two neighbours of a vertex along a border (N, 2): face, side, vertex.

    There a fin hides the border that a side without the vertex would have."""
    stride = int(found.ends.max(initial=0)) + 1
    middle, other = np.concatenate((border, border[:, ::-1])).T
    order = np.argsort(middle, kind="stable")
    middle, other = middle[order], other[order]
    tip, first, count = np.unique(middle, return_index=True, return_counts=True)
    tip, first = tip[count == 2], first[count == 2]
    a, b = other[first], other[first + 1]
    full = np.flatnonzero(found.face_count == 2)
    keys = found.ends[full, 0] * stride + found.ends[full, 1]
    wanted = np.minimum(a, b) * stride + np.maximum(a, b)
    place = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
    hit = (keys[place] == wanted) if len(keys) else np.zeros(len(wanted), dtype=np.bool_)
    vertex_of_edge = np.full(len(found.ends), -1, dtype=np.int64)
    vertex_of_edge[full[place[hit]]] = tip[hit]
    face, side = np.nonzero(vertex_of_edge[found.of_face] >= 0)
    return face, side, vertex_of_edge[found.of_face[face, side]]


def _split(faces: Faces, face: Ints, side: Ints, vertex: Ints, along: Floats) -> Faces:
    """Fan each face from the corner opposite its side over the vertices on it, which come in order."""
    starts = np.flatnonzero(np.append(True, face[1:] != face[:-1]))
    ends = np.append(starts[1:], len(face))
    changed, parts = faces.copy(), []
    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        row, turn = int(face[first]), int(side[first])
        a, b, c = (int(faces[row, (turn + step) % 3]) for step in range(3))
        stops = [a, *vertex[first:last].tolist(), b]
        fan = [(stops[i], stops[i + 1], c) for i in range(len(stops) - 1)]
        changed[row] = fan[0]
        parts += fan[1:]
    return np.concatenate((changed, np.array(parts, dtype=np.int32).reshape(-1, 3)))
