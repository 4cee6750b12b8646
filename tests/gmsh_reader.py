"""gmsh itself, as a reader of what we write."""

from __future__ import annotations

import signal
from pathlib import Path

import gmsh

SIMPLEX = {2: 2, 3: 4}
"""gmsh's numbers of the triangle and the tetrahedron, by dimension."""


def sizes_in_gmsh(path: Path, *, dimension: int) -> dict[int, int]:
    """How many triangles (`dimension` 2) or tetrahedra (3) gmsh finds in each physical group of `path`."""
    gmsh.initialize(interruptible=False)
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # gmsh takes Python's away: the next write to a closed socket would end us
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        groups = [tag for of, tag in gmsh.model.getPhysicalGroups() if of == dimension]
        return {tag: len(gmsh.model.mesh.getElementsByType(SIMPLEX[dimension], tag)[0]) for tag in groups}
    finally:
        gmsh.finalize()
