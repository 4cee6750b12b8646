"""Cracks: borders that run side by side and belong together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.adjacency import Edges, edges
from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WELD_SHARE = 0.25  # of the shortest edge at a border vertex: the farthest vertex it is joined with
LARGEST_WELD_SHARE = 0.5  # the same for a tolerance that was asked for: beyond it faces would turn over
NEAREST = 6  # vertices looked at around each: more of them are joined to it by edges only in odd meshes
HOST_SHARE = 0.05  # the same for a vertex that is not at a border: a wall may hide the border it had
ROUNDS = 16  # n copies of a vertex need about log2 n


def join_cracks(vertices: Vertices, faces: Faces, tolerance_mm: float | None = None) -> Staged:
    """Join vertices of borders that are each other's nearest, no edge apart, and near for the edges around them.

    The vertex with the lower number keeps its place. tolerance_mm: see `WELD_SHARE` for None. Where three sheets meet, the
    third is joined with what the first two became, though that is no border any more; and a border vertex that lies as good as
    on an inner one is joined with it.
    """
    kept: list[Ints] = []
    gaps: list[Floats] = []
    for _ in range(ROUNDS):
        found = edges(faces)
        # some were joined with others since, and are no vertices any more
        joined = np.intersect1d(np.concatenate(kept), found.ends) if kept else np.empty(0, dtype=np.int64)
        pairs, distances = _find_partners(vertices, found, tolerance_mm, joined)
        if len(pairs) == 0:
            pairs, distances = _find_hosts(vertices, found)
        if len(pairs) == 0:
            break
        number = np.arange(len(vertices))
        number[pairs[:, 1]] = pairs[:, 0]
        faces = number[faces].astype(np.int32)
        kept.append(pairs[:, 0])
        gaps.append(distances)
    if not kept:
        return vertices, faces, []
    points, distances = vertices[np.concatenate(kept)], np.concatenate(gaps)
    message = f"{len(points)} pairs of border vertices, up to {distances.max():.3g} mm apart, were joined"
    return vertices, faces, [Change("cracks", message, points, distances)]


def _find_hosts(vertices: Vertices, found: Edges) -> tuple[Ints, Floats]:
    """Border vertices and inner vertices very near to them: inner, border (K, 2) and distances (K,), each vertex once."""
    lone = np.unique(found.ends[found.face_count == 1])
    inner = np.setdiff1d(found.ends, lone)
    if len(lone) == 0 or len(inner) == 0:
        return np.empty((0, 2), dtype=np.int64), np.empty(0)
    scale = _shortest_edges(vertices, found)
    reach = HOST_SHARE * scale[lone]
    asked = cKDTree(vertices[inner]).query(vertices[lone], distance_upper_bound=float(reach.max()))
    distance, place = (np.asarray(found_there) for found_there in asked)
    rows = np.flatnonzero(place < len(inner))
    host = inner[place[rows]]
    stride = int(found.ends.max()) + 1
    keys = np.minimum(lone[rows], host) * stride + np.maximum(lone[rows], host)
    fits = distance[rows] <= np.minimum(reach[rows], HOST_SHARE * scale[host])
    fits &= ~np.isin(keys, found.ends[:, 0] * stride + found.ends[:, 1])
    rows, host = rows[fits], host[fits]
    host, first = np.unique(host, return_index=True)
    return np.column_stack((host, lone[rows[first]])), distance[rows[first]]


def _shortest_edges(vertices: Vertices, found: Edges) -> Floats:
    """Length of the shortest edge at each vertex, (V,) mm; infinite without edges."""
    lengths = np.linalg.norm(vertices[found.ends[:, 0]] - vertices[found.ends[:, 1]], axis=1)
    shortest = np.full(len(vertices), np.inf)
    for end in range(2):
        np.minimum.at(shortest, found.ends[:, end], lengths)
    return shortest


def _find_partners(vertices: Vertices, found: Edges, tolerance_mm: float | None, joined: Ints) -> tuple[Ints, Floats]:
    """Pairs to join, lower number first (K, 2), none with a vertex of another pair, and their distances (K,).

    joined: vertices that others were joined with before; they count as border, but two of them are no pair.
    """
    lone = np.unique(found.ends[found.face_count == 1])
    border = np.union1d(lone, joined) if len(lone) else lone
    scale = _shortest_edges(vertices, found)[border]
    if len(border) < 2:
        return np.empty((0, 2), dtype=np.int64), np.empty(0)
    reach = WELD_SHARE * scale if tolerance_mm is None else np.minimum(tolerance_mm, LARGEST_WELD_SHARE * scale)
    # neighbours in the list lie in space as they do in the file: the tree is asked within the largest reach only
    nearest_first = min(NEAREST + 1, len(border))
    asked = cKDTree(vertices[border]).query(
        vertices[border], k=nearest_first, distance_upper_bound=float(reach.max()) * (1.0 + 1e-12)
    )
    rows = np.repeat(np.arange(len(border)), nearest_first)
    distance, other = (np.asarray(found_there).ravel() for found_there in asked)
    fits = (other < len(border)) & (other != rows)
    rows, other, distance = rows[fits], other[fits], distance[fits]
    fits = distance <= np.minimum(reach[rows], reach[other])
    rows, other, distance = rows[fits], other[fits], distance[fits]
    stride = int(found.ends.max()) + 1
    a, b = border[rows], border[other]
    apart = ~np.isin(np.minimum(a, b) * stride + np.maximum(a, b), found.ends[:, 0] * stride + found.ends[:, 1])
    apart &= np.isin(a, lone) | np.isin(b, lone)
    rows, other, distance = rows[apart], other[apart], distance[apart]
    # the nearest of each, the lower number where two are equally near
    order = np.lexsort((other, distance, rows))
    first = np.ones(len(order), dtype=np.bool_)
    first[1:] = rows[order[1:]] != rows[order[:-1]]
    nearest = np.full(len(border), -1, dtype=np.int64)
    how_far = np.full(len(border), np.inf)
    nearest[rows[order[first]]] = other[order[first]]
    how_far[rows[order[first]]] = distance[order[first]]
    mine = np.arange(len(border))
    mutual = np.flatnonzero((nearest > mine) & (nearest[nearest] == mine))
    return np.column_stack((border[mutual], border[nearest[mutual]])), how_far[mutual]
