"""Canals cut out of a skin: exact subtraction of solids of air."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import manifold3d
import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.mesh import Mesh
from core.schema.finding import Severity
from core.validation.validate import validate

Ints = NDArray[np.int64]
SKIN = -1


@dataclass(frozen=True, eq=False, slots=True)
class CutSkin:
    """A skin with canals. canal_of_face: (F,) SKIN, or the number of the canal whose wall the face is.

    kept: number of faces, the first ones, that are the old skin's bit for bit."""

    mesh: Mesh
    canal_of_face: Ints
    kept: int


def cut_canals(skin: Mesh, canals: Mapping[str, Mesh]) -> CutSkin:
    """Subtract each canal; the triangles along the seams are as they fall.

    Needs:    a closed, oriented skin free of self-intersection; canals that reach from outside into the body.
    Promises: one closed surface of the skin's genus; faces no canal meets are kept bit for bit, in their order.
    Raises:   InputError `canal.not_closed`, `canal.unfit`, `canal.misses_skin`, `canal.splits_skin`, `canal.pierces_skin`.
    Source:   exact booleans of the library manifold (E. Lalish), in double precision.
    """
    cut = CutSkin(skin, np.full(len(skin.faces), SKIN, dtype=np.int64), len(skin.faces))
    for number, (name, canal) in enumerate(canals.items()):
        _require_solid(canal, name)
        cut = _subtract(cut, canal, number, name)
    return cut


def _require_solid(canal: Mesh, name: str) -> None:
    validation = validate({name: canal})
    errors = tuple(finding for finding in validation.findings if finding.severity is Severity.ERROR)
    if any(finding.code == "mesh.not_closed" for finding in errors):
        raise InputError(
            "canal.not_closed", f"the canal '{name}' is not closed, so it bounds no air", findings=errors, canal=name
        )
    if errors or validation.meshes[name].components != 1:
        words = errors[0].message if errors else f"it has {validation.meshes[name].components} pieces"
        raise InputError("canal.unfit", f"the canal '{name}' is no simple solid: {words}", findings=errors, canal=name)


def _subtract(cut: CutSkin, canal: Mesh, number: int, name: str) -> CutSkin:
    before, air = (
        manifold3d.Manifold(manifold3d.Mesh64(np.array(mesh.vertices), mesh.faces.astype(np.uint64)))
        for mesh in (cut.mesh, canal)
    )
    result = (before - air).to_mesh64()
    vertices, faces = np.array(result.vert_properties[:, :3]), np.asarray(result.tri_verts, dtype=np.int64)
    if len(faces) == 0:
        raise InputError("canal.splits_skin", f"nothing of the skin is left after cutting out the canal '{name}'", canal=name)
    # runs of triangles come from one solid each; what was subtracted is turned inside out
    starts = np.asarray(result.run_index, dtype=np.int64) // 3
    wall = np.repeat(np.asarray(result.run_flags, dtype=np.int64) & 1, starts[1:] - starts[:-1]) == 1
    vertices, faces = _renumbered(cut.mesh, vertices, faces)
    former = _former_faces(cut.mesh.faces, faces)
    faces[former >= 0] = cut.mesh.faces[former[former >= 0]]  # with the same corner first
    pieces, _label = face_components(edges(faces.astype(np.int32)))
    if pieces != 1:
        raise InputError(
            "canal.splits_skin",
            f"cutting out the canal '{name}' leaves {pieces} surfaces: it cuts the body in pieces or ends in a closed hollow",
            canal=name,
            pieces=pieces,
        )
    if not wall.any():
        raise InputError("canal.misses_skin", f"the canal '{name}' lies outside the body and does not touch the skin", canal=name)
    handles = (_euler(cut.mesh.faces) - _euler(faces)) // 2
    if handles != 0:
        raise InputError(
            "canal.pierces_skin",
            f"the canal '{name}' opens at {handles + 1} places of the skin, not at one: a tunnel would remain",
            canal=name,
            openings=int(handles + 1),
        )
    owner = np.where(former >= 0, cut.canal_of_face[former], np.where(wall, number, SKIN))
    order = np.argsort(np.where(former >= 0, former, len(cut.mesh.faces)), kind="stable")
    kept = int((former[order] < cut.kept)[: int((former >= 0).sum())].sum())
    return _dropping_unused(vertices, faces[order], owner[order], kept)


def _renumbered(skin: Mesh, vertices: NDArray[np.float64], faces: Ints) -> tuple[NDArray[np.float64], Ints]:
    """Vertices of the skin first, under their old numbers, then the new ones in their order."""
    places = np.concatenate((skin.vertices, vertices))
    _unique, first, of_place = np.unique(places, axis=0, return_index=True, return_inverse=True)
    number = first[of_place.ravel()][len(skin.vertices) :]
    new = number >= len(skin.vertices)
    ids = np.unique(number[new])
    number[new] = len(skin.vertices) + np.searchsorted(ids, number[new])
    return np.concatenate((skin.vertices, places[ids])), number[faces]


def _former_faces(old: NDArray[np.int32], faces: Ints) -> Ints:
    """The number each face had before, or -1 if it is new; (F,)."""
    known = {tuple(face): number for number, face in enumerate(_turned(old.astype(np.int64)).tolist())}
    return np.array([known.get(tuple(face), -1) for face in _turned(faces).tolist()], dtype=np.int64)


def _turned(faces: Ints) -> Ints:
    """The same faces, each beginning at its lowest vertex."""
    start = np.argmin(faces, axis=1)[:, None]
    turned: Ints = np.take_along_axis(faces, (start + np.arange(3)) % 3, axis=1)
    return turned


def _euler(faces: NDArray[np.integer]) -> int:
    sides = edges(faces.astype(np.int32))
    return len(np.unique(faces)) - len(sides.ends) + len(faces)


def _dropping_unused(vertices: NDArray[np.float64], faces: Ints, owner: Ints, kept: int) -> CutSkin:
    used, renumbered = np.unique(faces, return_inverse=True)
    return CutSkin(Mesh.of(vertices[used], renumbered.reshape(-1, 3)), owner, kept)
