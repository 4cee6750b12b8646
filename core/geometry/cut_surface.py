"""A surface that solids are cut out of: exact subtraction, with the account of which faces are whose."""

from __future__ import annotations

from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.mesh import Mesh

Ints = NDArray[np.int64]
SKIN = -1


@dataclass(frozen=True, eq=False, slots=True)
class CutSurface:
    """A surface with solids cut out. piece: (F,) SKIN, or the number of the solid whose wall the face is.

    kept: number of faces, the first ones, that are the old surface's bit for bit."""

    mesh: Mesh
    piece: Ints
    kept: int

    @classmethod
    def uncut(cls, mesh: Mesh) -> CutSurface:
        """Before anything is cut out of it."""
        return cls(mesh, np.full(len(mesh.faces), SKIN, dtype=np.int64), len(mesh.faces))

    def without(self, solid: Mesh, number: int) -> CutSurface | None:
        """The surface after one more solid is taken away, its walls numbered; None if nothing is left of it.

        Needs: both closed, outward and free of self-intersection. Promises: faces that do not meet the solid are kept bit for
        bit, in their order. Source: exact booleans of the library manifold (E. Lalish), in double precision."""
        before, air = (
            manifold3d.Manifold(manifold3d.Mesh64(np.array(mesh.vertices), mesh.faces.astype(np.uint64)))
            for mesh in (self.mesh, solid)
        )
        result = (before - air).to_mesh64()
        vertices, faces = np.array(result.vert_properties[:, :3]), np.asarray(result.tri_verts, dtype=np.int64)
        if len(faces) == 0:
            return None
        # runs of triangles come from one solid each; what was subtracted is turned inside out
        starts = np.asarray(result.run_index, dtype=np.int64) // 3
        wall = np.repeat(np.asarray(result.run_flags, dtype=np.int64) & 1, starts[1:] - starts[:-1]) == 1
        vertices, faces = _renumbered(self.mesh, vertices, faces)
        former = _former_faces(self.mesh.faces, faces)
        faces[former >= 0] = self.mesh.faces[former[former >= 0]]  # with the same corner first
        owner = np.where(former >= 0, self.piece[former], np.where(wall, number, SKIN))
        order = np.argsort(np.where(former >= 0, former, len(self.mesh.faces)), kind="stable")
        kept = int((former[order] < self.kept)[: int((former >= 0).sum())].sum())
        return _dropping_unused(vertices, faces[order], owner[order], kept)


def _manifold(mesh: Mesh) -> manifold3d.Manifold:
    return manifold3d.Manifold(manifold3d.Mesh64(np.array(mesh.vertices), mesh.faces.astype(np.uint64)))


def euler_characteristic(faces: NDArray[np.integer]) -> int:
    """V - E + F of the vertices that faces (F, 3) use."""
    sides = edges(faces.astype(np.int32))
    return len(np.unique(faces)) - len(sides.ends) + len(faces)


def _renumbered(base: Mesh, vertices: NDArray[np.float64], faces: Ints) -> tuple[NDArray[np.float64], Ints]:
    """Vertices of the base first, under their old numbers, then the new ones in their order."""
    places = np.concatenate((base.vertices, vertices))
    _unique, first, of_place = np.unique(places, axis=0, return_index=True, return_inverse=True)
    number = first[of_place.ravel()][len(base.vertices) :]
    new = number >= len(base.vertices)
    ids = np.unique(number[new])
    number[new] = len(base.vertices) + np.searchsorted(ids, number[new])
    return np.concatenate((base.vertices, places[ids])), number[faces]


def _former_faces(old: NDArray[np.int32], faces: Ints) -> Ints:
    """The number each face had before, or -1 if it is new; (F,)."""
    known = {tuple(face): number for number, face in enumerate(_turned(old.astype(np.int64)).tolist())}
    return np.array([known.get(tuple(face), -1) for face in _turned(faces).tolist()], dtype=np.int64)


def _turned(faces: Ints) -> Ints:
    """The same faces, each beginning at its lowest vertex."""
    start = np.argmin(faces, axis=1)[:, None]
    turned: Ints = np.take_along_axis(faces, (start + np.arange(3)) % 3, axis=1)
    return turned


def _dropping_unused(vertices: NDArray[np.float64], faces: Ints, owner: Ints, kept: int) -> CutSurface:
    used, renumbered = np.unique(faces, return_inverse=True)
    return CutSurface(Mesh.of(vertices[used], renumbered.reshape(-1, 3)), owner, kept)
