"""Canals cut out of a skin: exact subtraction of solids of air."""

from __future__ import annotations

from collections.abc import Mapping

from core.errors import InputError
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.cut_surface import CutSurface, euler_characteristic
from core.mesh import Mesh
from core.schema.finding import Severity
from core.validation.validate import validate


def cut_canals(skin: Mesh, canals: Mapping[str, Mesh]) -> CutSurface:
    """Subtract each canal; the triangles along the seams are as they fall.

    Needs:    a closed, oriented skin free of self-intersection; canals that reach from outside into the body.
    Promises: one closed surface of the skin's genus; faces no canal meets are kept bit for bit, in their order.
    Raises:   InputError `canal.not_closed`, `canal.unfit`, `canal.misses_skin`, `canal.splits_skin`, `canal.pierces_skin`.
    Source:   exact booleans of the library manifold (E. Lalish), in double precision.
    """
    cut = CutSurface.uncut(skin)
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


def _subtract(before: CutSurface, canal: Mesh, number: int, name: str) -> CutSurface:
    cut = before.without(canal, number)
    if cut is None:
        raise InputError("canal.splits_skin", f"nothing of the skin is left after cutting out the canal '{name}'", canal=name)
    pieces, _label = face_components(edges(cut.mesh.faces))
    if pieces != 1:
        raise InputError(
            "canal.splits_skin",
            f"cutting out the canal '{name}' leaves {pieces} surfaces: it cuts the body in pieces or ends in a closed hollow",
            canal=name,
            pieces=pieces,
        )
    if not (cut.piece == number).any():
        raise InputError("canal.misses_skin", f"the canal '{name}' lies outside the body and does not touch the skin", canal=name)
    handles = (euler_characteristic(before.mesh.faces) - euler_characteristic(cut.mesh.faces)) // 2
    if handles != 0:
        raise InputError(
            "canal.pierces_skin",
            f"the canal '{name}' opens at {handles + 1} places of the skin, not at one: a tunnel would remain",
            canal=name,
            openings=int(handles + 1),
        )
    return cut
