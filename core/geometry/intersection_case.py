"""Which of two intersecting faces is pierced by the other: the three cases of thesis Fig. 19, decided exactly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.exact_predicates import Points, Signs, orient2d, orient3d

Corners = NDArray[np.float64]


def classify_intersections(a: Corners, b: Corners) -> Signs:
    """Case of each pair of triangles a, b (N, 3, 3), a of the master mesh, b of the slave.

    Returns (N,): 1 only sides of b meet the face a, 2 sides of both meet the other face, 3 only sides of a meet the
    face b, 0 the triangles do not meet. Faces and sides are closed sets, so touching counts, and so do coplanar
    triangles: overlapping ones are case 2, one that lies within the other is case 1 or 3.
    Triangles must have an area.
    """
    b_meets_a = np.zeros(len(a), dtype=bool)
    a_meets_b = np.zeros(len(a), dtype=bool)
    for i in range(3):
        b_meets_a |= meets_triangle(b[:, i], b[:, (i + 1) % 3], a)
        a_meets_b |= meets_triangle(a[:, i], a[:, (i + 1) % 3], b)
    return np.select([b_meets_a & a_meets_b, b_meets_a, a_meets_b], [2, 1, 3], 0).astype(np.int8)


def meets_triangle(p: Points, q: Points, triangle: Corners) -> NDArray[np.bool_]:
    """True where the segment p-q (N, 3) has a point in common with the triangle (N, 3, 3), borders included."""
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    side_p, side_q = orient3d(a, b, c, p), orient3d(a, b, c, q)
    meets = np.zeros(len(p), dtype=bool)
    cutting = np.flatnonzero((side_p * side_q <= 0) & ((side_p != 0) | (side_q != 0)))
    if len(cutting):
        p_, q_, t = p[cutting], q[cutting], triangle[cutting]
        turns = np.column_stack([orient3d(p_, q_, t[:, i], t[:, (i + 1) % 3]) for i in range(3)])
        meets[cutting] = (turns >= 0).all(axis=1) | (turns <= 0).all(axis=1)
    flat = np.flatnonzero((side_p == 0) & (side_q == 0))
    if len(flat):
        meets[flat] = _meets_in_plane(p[flat], q[flat], triangle[flat])
    return meets


def _meets_in_plane(p: Points, q: Points, triangle: Corners) -> NDArray[np.bool_]:
    """`meets_triangle` for segments in the plane of the triangle, seen along an axis that does not squash it."""
    meets = np.zeros(len(p), dtype=bool)
    open_cases = np.ones(len(p), dtype=bool)
    for plane in ([0, 1], [1, 2], [2, 0]):
        a, b, c = (triangle[:, i][:, plane] for i in range(3))
        turn = orient2d(a, b, c)
        now = np.flatnonzero(open_cases & (turn != 0))
        open_cases[now] = False
        if len(now):
            meets[now] = _meets_flat(p[now][:, plane], q[now][:, plane], (a[now], b[now], c[now]), turn[now])
    return meets


def _meets_flat(p: Points, q: Points, corners: tuple[Points, Points, Points], turn: Signs) -> NDArray[np.bool_]:
    """Plane segments against plane triangles of non-zero orientation `turn`, borders included."""
    inside = np.ones(len(p), dtype=bool)
    crossing = np.zeros(len(p), dtype=bool)
    for i in range(3):
        a, b = corners[i], corners[(i + 1) % 3]
        at_p, at_q = orient2d(a, b, p), orient2d(a, b, q)
        inside &= at_p * turn >= 0
        at_a, at_b = orient2d(p, q, a), orient2d(p, q, b)
        in_line = (at_p == 0) & (at_q == 0)
        overlap = (np.maximum(p, q) >= np.minimum(a, b)).all(axis=1) & (np.maximum(a, b) >= np.minimum(p, q)).all(axis=1)
        crossing |= np.where(in_line, overlap, (at_p * at_q <= 0) & (at_a * at_b <= 0))
    return inside | crossing
