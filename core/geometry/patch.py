"""A part of a surface whose connectivity may change: split, collapse, flip, move. Small, so plain Python."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.geometry.triangle_shape import Point, closest_distance, cross, dot, minus, quality
from core.mesh import Mesh

Ints = NDArray[np.int64]
Triangle = tuple[int, int, int]

STEEPEST_TURN = 0.5  # cosine: an edit may turn no face by more than 60 degrees


@dataclass(slots=True)
class Patch:
    """Triangles that may change inside a surface that may not.

    points: places by vertex, mm. triangles: by number. piece: the surface each triangle belongs to; edges between pieces
    form the seam. around: the patch's triangles at each vertex. rim: vertices that others of the surface's triangles use:
    they stay, and `beyond` holds their neighbours across edges that no patch triangle has.
    tolerance_mm: how far an edit may take the surface from a vertex it had before.
    """

    points: list[Point]
    triangles: dict[int, Triangle]
    piece: dict[int, int]
    tolerance_mm: float
    rim: frozenset[int]
    beyond: dict[int, set[int]]
    next_number: int
    around: dict[int, set[int]] = field(default_factory=lambda: defaultdict(set))

    @classmethod
    def of(cls, mesh: Mesh, piece: Ints, chosen: NDArray[np.bool_], tolerance_mm: float) -> Patch:
        """The chosen faces (F,) of a mesh; piece (F,)."""
        numbers = np.flatnonzero(chosen).tolist()
        triangles: dict[int, Triangle] = dict(zip(numbers, map(tuple, mesh.faces[chosen].tolist()), strict=True))
        rest = mesh.faces[~chosen]
        rim = np.intersect1d(mesh.faces[chosen], rest)
        beyond: dict[int, set[int]] = defaultdict(set)
        for face in rest[np.isin(rest, rim).any(axis=1)].tolist():
            for vertex in face:
                beyond[vertex].update(face)
        patch = cls(
            [(x, y, z) for x, y, z in mesh.vertices.tolist()],
            triangles,
            {number: int(piece[number]) for number in numbers},
            tolerance_mm,
            frozenset(rim.tolist()),
            beyond,
            len(mesh.faces),
        )
        for number, triangle in triangles.items():
            for vertex in triangle:
                patch.around[vertex].add(number)
        return patch

    def edges(self) -> list[tuple[int, int]]:
        """Edges inside the patch, lower vertex first, sorted."""
        count: dict[tuple[int, int], int] = defaultdict(int)
        for a, b, c in self.triangles.values():
            for u, v in ((a, b), (b, c), (c, a)):
                count[min(u, v), max(u, v)] += 1
        return sorted(edge for edge, faces in count.items() if faces == 2)

    def at_edge(self, u: int, v: int) -> list[int]:
        """The patch's triangles at an edge."""
        return sorted(self.around[u] & self.around[v])

    def is_seam_edge(self, u: int, v: int) -> bool:
        """True if the pieces on its two sides differ."""
        return len({self.piece[number] for number in self.at_edge(u, v)}) > 1

    def is_seam(self, vertex: int) -> bool:
        """True if the vertex has triangles of several pieces."""
        return len({self.piece[number] for number in self.around[vertex]}) > 1

    def neighbours(self, vertex: int) -> set[int]:
        """All vertices joined to it, in the patch or beyond."""
        found = {other for number in self.around[vertex] for other in self.triangles[number]} | self.beyond.get(vertex, set())
        return found - {vertex}

    def seam_neighbours(self, vertex: int) -> list[int]:
        """Vertices before and after it on the seam."""
        joined = {other for number in self.around[vertex] for other in self.triangles[number]} - {vertex}
        return sorted(other for other in joined if len(self.at_edge(vertex, other)) == 2 and self.is_seam_edge(vertex, other))

    def length(self, u: int, v: int) -> float:
        """mm."""
        apart = minus(self.points[u], self.points[v])
        return float(dot(apart, apart) ** 0.5)

    def lowest_quality(self, triangles: Iterable[Triangle]) -> float:
        """q of the worst of them."""
        return min(quality(*(self.points[vertex] for vertex in triangle)) for triangle in triangles)

    def split(self, u: int, v: int) -> int:
        """Halve an edge; the number of the new vertex."""
        middle = len(self.points)
        x, y, z = ((np.float32((a + b) / 2)) for a, b in zip(self.points[u], self.points[v], strict=True))
        self.points.append((float(x), float(y), float(z)))
        for number in self.at_edge(u, v):
            old = self.triangles[number]
            self._replace(number, _with(old, u, middle))
            self._add(_with(old, v, middle), self.piece[number])
        return middle

    def flip(self, u: int, v: int) -> bool:
        """Turn an edge inside its quadrangle where this raises the lowest quality; False if it may not."""
        numbers = self.at_edge(u, v)
        if len(numbers) != 2 or self.is_seam_edge(u, v):
            return False
        first, second = (self.triangles[number] for number in numbers)
        a, b = (next(vertex for vertex in triangle if vertex not in (u, v)) for triangle in (first, second))
        if b in self.neighbours(a) or self._gap(u, v, a, b) > self.tolerance_mm:
            return False
        turned = (_with(first, v, b), _with(second, u, a))
        if self.lowest_quality(turned) <= self.lowest_quality((first, second)) + 1e-3:
            return False
        normals = [self._normal(triangle) for triangle in (first, second)]
        if any(not _alike(self._normal(triangle), normal) for triangle in turned for normal in normals):
            return False
        self._replace(numbers[0], turned[0])
        self._replace(numbers[1], turned[1])
        return True

    def collapse(self, gone: int, kept: int, least_quality: float) -> bool:
        """Merge a vertex into its neighbour where nothing but the shape of triangles changes; False if it may not.

        The lowest quality around must afterwards be `least_quality`, or no worse than before."""
        numbers = self.at_edge(gone, kept)
        if gone in self.rim or len(numbers) != 2 or (self.is_seam(gone) and not self.is_seam_edge(gone, kept)):
            return False
        opposite = {vertex for number in numbers for vertex in self.triangles[number]} - {gone, kept}
        if self.neighbours(gone) & self.neighbours(kept) != opposite:
            return False
        moved = sorted(self.around[gone] - set(numbers))
        before = [self.triangles[number] for number in sorted(self.around[gone])]
        after = [_with(self.triangles[number], gone, kept) for number in moved]
        if len(after) < 2 or self.lowest_quality(after) < min(least_quality, self.lowest_quality(before)):
            return False
        if not self._stays_near([self.triangles[number] for number in moved], after, self.points[gone]):
            return False
        for number in numbers:
            self._remove(number)
        for number, triangle in zip(moved, after, strict=True):
            self._replace(number, triangle)
        return True

    def move(self, vertex: int, place: Point, least_quality: float) -> bool:
        """Put a vertex elsewhere, by the rules of `collapse`; False if it may not."""
        triangles = [self.triangles[number] for number in sorted(self.around[vertex])]
        before, lowest = self.points[vertex], self.lowest_quality(triangles)
        normals = [self._normal(triangle) for triangle in triangles]
        self.points[vertex] = place
        if (
            self.lowest_quality(triangles) < min(least_quality, lowest)
            or any(not _alike(self._normal(now), normal) for now, normal in zip(triangles, normals, strict=True))
            or self._distance(before, triangles) > self.tolerance_mm
        ):
            self.points[vertex] = before
            return False
        return True

    def _stays_near(self, before: list[Triangle], after: list[Triangle], lost: Point) -> bool:
        turned = (not _alike(self._normal(old), self._normal(new)) for old, new in zip(before, after, strict=True))
        return not any(turned) and self._distance(lost, after) <= self.tolerance_mm

    def _distance(self, point: Point, triangles: list[Triangle]) -> float:
        return min(closest_distance(point, *(self.points[vertex] for vertex in triangle)) for triangle in triangles)

    def _gap(self, u: int, v: int, a: int, b: int) -> float:
        """Distance of the two diagonals of a quadrangle."""
        across = cross(minus(self.points[v], self.points[u]), minus(self.points[b], self.points[a]))
        length = dot(across, across) ** 0.5
        if length == 0.0:
            return float("inf")
        return float(abs(dot(minus(self.points[a], self.points[u]), across)) / length)

    def _normal(self, triangle: Triangle) -> Point:
        a, b, c = (self.points[vertex] for vertex in triangle)
        return cross(minus(b, a), minus(c, a))

    def _add(self, triangle: Triangle, piece: int) -> None:
        number, self.next_number = self.next_number, self.next_number + 1
        self.triangles[number] = triangle
        self.piece[number] = piece
        for vertex in triangle:
            self.around[vertex].add(number)

    def _replace(self, number: int, triangle: Triangle) -> None:
        for vertex in self.triangles[number]:
            self.around[vertex].discard(number)
        self.triangles[number] = triangle
        for vertex in triangle:
            self.around[vertex].add(number)

    def _remove(self, number: int) -> None:
        for vertex in self.triangles.pop(number):
            self.around[vertex].discard(number)
        del self.piece[number]


def _with(triangle: Triangle, old: int, new: int) -> Triangle:
    a, b, c = (new if vertex == old else vertex for vertex in triangle)
    return a, b, c


def _alike(first: Point, second: Point) -> bool:
    """True if two normals, of any length, differ by less than the steepest turn; a sliver's zero normal is like any."""
    sizes = dot(first, first) * dot(second, second)
    return sizes < 1e-18 or dot(first, second) >= STEEPEST_TURN * sizes**0.5
