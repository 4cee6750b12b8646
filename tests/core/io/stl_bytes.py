"""Binary STL files put together by hand, so that each part can be wrong on its own."""

from __future__ import annotations

import struct
from collections.abc import Iterable

import numpy as np

from core.mesh import Mesh
from tests.core.io.tiny import TETRAHEDRON


def binary_stl(mesh: Mesh = TETRAHEDRON, *, header: bytes = b"by hand", count: int | None = None, tail: bytes = b"") -> bytes:
    """A file whose header says `count` facets, whatever it holds, with `tail` after the last one."""
    corners = mesh.triangles().tolist()
    declared = len(corners) if count is None else count
    return header.ljust(80, b"\0") + struct.pack("<I", declared) + b"".join(facet(corner) for corner in corners) + tail


def facet(corners: Iterable[Iterable[float]]) -> bytes:
    """50 bytes: no normal, three corners, no attributes."""
    return struct.pack("<3f", 0, 0, 0) + np.array(list(corners), dtype="<f4").tobytes() + b"\0\0"
