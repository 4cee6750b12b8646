"""One triangle at a time, in plain numbers: for edits that look at a handful."""

from __future__ import annotations

Point = tuple[float, float, float]


def minus(a: Point, b: Point) -> Point:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def dot(a: Point, b: Point) -> float:
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Point, b: Point) -> Point:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def quality(a: Point, b: Point, c: Point) -> float:
    """q = 2 r_in / r_out of a triangle; 0 without area. `core.geometry.quality` in numbers."""
    u, v, w = minus(b, a), minus(c, b), minus(a, c)
    x, y, z = dot(u, u) ** 0.5, dot(v, v) ** 0.5, dot(w, w) ** 0.5
    normal = cross(u, v)
    product = x * y * z * (x + y + z)
    return 4.0 * dot(normal, normal) / product if product > 0.0 else 0.0


def closest_distance(p: Point, a: Point, b: Point, c: Point) -> float:
    """Distance of a point to a triangle, mm."""
    u, v, w = minus(b, a), minus(c, a), minus(p, a)
    normal = cross(u, v)
    size = dot(normal, normal)
    if size > 0.0:
        beside_b = dot(cross(w, v), normal) / size
        beside_c = dot(cross(u, w), normal) / size
        if beside_b >= 0.0 and beside_c >= 0.0 and beside_b + beside_c <= 1.0:
            return float(abs(dot(w, normal)) / size**0.5)
    return min(_to_side(p, a, b), _to_side(p, b, c), _to_side(p, c, a))


def _to_side(p: Point, a: Point, b: Point) -> float:
    side, w = minus(b, a), minus(p, a)
    length = dot(side, side)
    share = min(max(dot(w, side) / length, 0.0), 1.0) if length > 0.0 else 0.0
    rest = (w[0] - share * side[0], w[1] - share * side[1], w[2] - share * side[2])
    return float(dot(rest, rest) ** 0.5)
