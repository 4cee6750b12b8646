"""gmsh itself, as a reader of what we write, and as a writer of what we read."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import gmsh
import numpy as np
from numpy.typing import NDArray

SIMPLEX = {2: 2, 3: 4}
"""gmsh's numbers of the triangle and the tetrahedron, by dimension."""


@contextmanager
def _opened(path: Path) -> Iterator[None]:
    gmsh.initialize(interruptible=False)
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # gmsh takes Python's away: the next write to a closed socket would end us
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        yield
    finally:
        gmsh.finalize()


def sizes_in_gmsh(path: Path, *, dimension: int) -> dict[int, int]:
    """How many triangles (`dimension` 2) or tetrahedra (3) gmsh finds in each physical group of `path`."""
    with _opened(path):
        groups = [tag for of, tag in gmsh.model.getPhysicalGroups() if of == dimension]
        return {tag: len(gmsh.model.mesh.getElementsByType(SIMPLEX[dimension], tag)[0]) for tag in groups}


def data_in_gmsh(path: Path) -> dict[str, NDArray[np.float64]]:
    """Name of each data of `path` -> its values (N, components), in the order of their elements or nodes."""
    with _opened(path):
        found = {}
        for tag in gmsh.view.getTags():
            name = gmsh.option.getString(f"View[{gmsh.view.getIndex(tag)}].Name")
            _, _, values, _, components = gmsh.view.getHomogeneousModelData(tag, 0)
            found[name] = values.reshape(-1, components)
        return found


def rewrite_by_gmsh(path: Path, target: Path, *, version: float, binary: bool) -> None:
    """What gmsh makes of a file with data in another version of its format."""
    with _opened(path):
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", int(binary))
        gmsh.write(str(target))
        gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
        for tag in gmsh.view.getTags():
            gmsh.view.write(tag, str(target), append=True)
