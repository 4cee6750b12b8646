"""Vertices of a closed surface where several fans meet, like the waist of a bow tie."""

from __future__ import annotations

from core.geometry.adjacency import edges
from core.geometry.components import find_split_vertices
from core.healing.borders import fans
from core.healing.change import Staged
from core.healing.fan_splitting import split_fans
from core.mesh import Faces, Vertices


def part_pinched_vertices(vertices: Vertices, faces: Faces) -> Staged:
    """Part the fans of faces that meet in one vertex only. Needs edges with at most two faces."""
    found = edges(faces)
    pinched = find_split_vertices(faces, found)
    if len(pinched) == 0:
        return vertices, faces, []
    what = "vertices in which several fans of faces met were parted"
    return split_fans(vertices, faces, fans(found), "pinched_vertices", what, pinched)
