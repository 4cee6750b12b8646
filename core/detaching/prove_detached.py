"""What opening a contact promises, proven on its result."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError
from core.geometry.adjacency import edges
from core.geometry.components import face_components, find_split_vertices
from core.geometry.cut_surface import euler_characteristic
from core.mesh import Mesh

Flags = NDArray[np.bool_]
Box = tuple[Sequence[float], Sequence[float]]


def count_pieces(mesh: Mesh) -> int:
    """Closed surfaces that hang together by edges."""
    return face_components(edges(mesh.faces))[0]


def measure_genus(mesh: Mesh) -> int:
    """Handles of all pieces of a closed surface."""
    return count_pieces(mesh) - euler_characteristic(mesh.faces) // 2


def prove_detached(before: Mesh, after: Mesh, boxes: Sequence[Box]) -> Flags:
    """True for the faces (F,) of `after` that `before` has not, by their places.

    Raises: InternalError `detach.not_proven` unless the surface is closed and manifold, and every face that came or went lies
    with all its corners in one of the boxes. (Self-intersection is proven exactly on the file that is delivered.)"""
    net = edges(after.faces)
    if not (net.face_count == 2).all() or len(find_split_vertices(after.faces, net)):
        raise InternalError("detach.not_proven", "the opened skin is not closed and manifold")
    old, new = _keys(before), _keys(after)
    gone, came = ~np.isin(old, new), ~np.isin(new, old)
    for mesh, changed in ((before, gone), (after, came)):
        corners = mesh.triangles()[changed]
        inside = np.zeros(len(corners), dtype=np.bool_)
        for low, high in boxes:
            inside |= ((corners >= np.array(low)) & (corners <= np.array(high))).all(axis=(1, 2))
        if not inside.all():
            count = int((~inside).sum())
            raise InternalError("detach.not_proven", f"{count} faces that reach out of the regions changed", count=count)
    return came


def _keys(mesh: Mesh) -> NDArray[np.void]:
    """One value per face, equal for equal places in the same turn, whichever corner comes first."""
    corners = mesh.triangles() + 0.0  # no negative zeros
    first = np.lexsort((corners[:, :, 2], corners[:, :, 1], corners[:, :, 0]), axis=1)[:, :1]
    turned = np.take_along_axis(corners, ((first + np.arange(3)) % 3)[:, :, None], axis=1)
    return np.ascontiguousarray(turned.reshape(-1, 9)).view([("", np.void, 72)]).ravel()
