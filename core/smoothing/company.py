"""The surfaces smoothed together as they are now: what each keeps its distance from, and which lies in which."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.containment import find_crossings
from core.geometry.face_tree import FaceTree
from core.geometry.volume import signed_volumes
from core.mesh import Faces, Mesh, Vertices

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class _Pieces:
    """label: (F,) piece of each face. vertex: one of each piece. closed: all of them are."""

    label: Ints
    vertex: Ints
    closed: bool

    @classmethod
    def of(cls, faces: Faces) -> _Pieces:
        table = edges(faces)
        label = face_components(table)[1]
        first = np.unique(label, return_index=True)[1]
        return cls(label, faces[first, 0].astype(np.int64), bool((table.face_count == 2).all()))


class Company:
    """Trees over all surfaces, brought up to date as they move.

    A step is not a continuous motion: a small piece could jump through a wall and end on its other side, sound and apart.
    So after each step every closed piece must lie in the same others as before, and look the same way.
    """

    def __init__(self, meshes: Mapping[str, Mesh]) -> None:
        """The surfaces before the first step."""
        self._pieces = {name: _Pieces.of(mesh.faces) for name, mesh in meshes.items()}
        self._trees = {name: FaceTree.of(mesh.vertices, mesh.faces) for name, mesh in meshes.items()}
        self._points = {name: mesh.vertices[self._pieces[name].vertex] for name, mesh in meshes.items()}
        self._lonely = sum(len(pieces.vertex) for pieces in self._pieces.values()) == 1
        self._at_first = {name: self._arrangement(name, mesh.vertices, mesh.faces) for name, mesh in meshes.items()}

    def tree(self, name: str) -> FaceTree:
        """Of one surface."""
        return self._trees[name]

    def others(self, name: str) -> tuple[FaceTree, ...]:
        """What a surface keeps its distance from."""
        return tuple(tree for other, tree in self._trees.items() if other != name)

    def is_closed(self, name: str) -> bool:
        """Every edge has two faces."""
        return self._pieces[name].closed

    def admits(self, name: str, vertices: Vertices, faces: Faces) -> bool:
        """True if every piece still lies in the same others; then the surface counts as being there (V, 3), (F, 3)."""
        tree, points = self._trees[name], self._points[name]
        if not self._lonely:
            self._trees[name] = FaceTree.of(vertices, faces)
            self._points[name] = vertices[self._pieces[name].vertex]
        if self._arrangement(name, vertices, faces) == self._at_first[name]:
            return True
        self._trees[name], self._points[name] = tree, points
        return False

    def _arrangement(self, name: str, vertices: Vertices, faces: Faces) -> tuple[bytes, ...]:
        """Which way the pieces of a surface look, what they hold, and what holds them."""
        pieces = self._pieces[name]
        known: list[NDArray[np.bool_]] = []
        if pieces.closed:
            known.append(signed_volumes(vertices, faces, pieces.label) > 0.0)
        if not self._lonely:
            known += [self._holding(other, self._points[name], own=other == name) for other in self._pieces]
            known += [self._holding(name, points, own=False) for other, points in self._points.items() if other != name]
        return tuple(flags.tobytes() for flags in known)

    def _holding(self, name: str, points: Vertices, *, own: bool) -> NDArray[np.bool_]:
        """Which pieces of a closed surface hold which points (K, pieces); a piece does not hold itself."""
        pieces = self._pieces[name]
        if not pieces.closed:
            return np.zeros(0, dtype=np.bool_)
        point, face = find_crossings(self._trees[name], points)
        count = len(pieces.vertex)
        keys = point * count + pieces.label[face]
        holding: NDArray[np.bool_] = np.bincount(keys, minlength=len(points) * count).reshape(-1, count) % 2 == 1
        if own:
            np.fill_diagonal(holding, False)
        return holding
