"""`python -m benchmarks.fill_with_tetrahedra FILE.stl...`: does TetGen accept all surfaces together? It may crash, alone.

Exit code 0 and the number of tetrahedra if so.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import tetgen

from core.io.registry import read_meshes


def main() -> None:
    """The files are the arguments; `pYQ`: keep every facet, split none, be quiet."""
    meshes = [read_meshes(Path(name), file_name=name, unit="mm").meshes[0].mesh for name in sys.argv[1:]]
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=False)])
    _nodes, tetrahedra, *_ = tetgen.TetGen(np.concatenate([mesh.vertices for mesh in meshes]), faces).tetrahedralize(
        switches="pYQ"
    )
    print(len(tetrahedra))


if __name__ == "__main__":
    main()
