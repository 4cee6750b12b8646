"""The volume that a surface with holes would enclose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.volume import signed_volumes
from core.healing.borders import find_loops
from core.mesh import Faces, Vertices


def piece_volumes(vertices: Vertices, faces: Faces) -> NDArray[np.float64]:
    """Signed volume of each piece, its holes closed by cones from the middles of their rims, mm³.

    Needs edges with at most two faces and consistent orientation.
    """
    piece = face_components(edges(faces))[1]
    cones: list[NDArray[np.int64]] = []
    tips: list[NDArray[np.float64]] = []
    owner: list[NDArray[np.int64]] = []
    of_vertex = np.zeros(len(vertices), dtype=np.int64)
    of_vertex[faces] = piece[:, None]
    for loop in find_loops(faces):
        tip = len(vertices) + len(tips)
        tips.append(vertices[loop].mean(axis=0))
        cones.append(np.column_stack((loop, np.roll(loop, -1), np.full(len(loop), tip))))
        owner.append(np.full(len(loop), of_vertex[loop[0]]))
    if not cones:
        return signed_volumes(vertices, faces, piece)
    places = np.concatenate((vertices, np.array(tips)))
    closed = np.concatenate((faces, *cones)).astype(np.int32)
    return signed_volumes(places, closed, np.concatenate((piece, *owner)))
