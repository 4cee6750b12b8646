"""Give all shells of a package together to TetGen, which refuses surfaces that meet; prints the number of tetrahedra.

A program of its own, because TetGen ends the process when it gives up.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import tetgen

from core.package.read import read_shells

KEEP_SURFACES = "pYQ"  # fill the surfaces, add no points on them, be quiet


def main() -> int:
    """The package is the first argument; exit code 0 if TetGen accepts it."""
    meshes = list(read_shells(Path(sys.argv[1])).values())
    first_vertex = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    faces = np.concatenate([mesh.faces + np.int32(start) for mesh, start in zip(meshes, first_vertex, strict=False)])
    try:
        _, tetrahedra, *_ = tetgen.TetGen(vertices, faces).tetrahedralize(switches=KEEP_SURFACES)
    except RuntimeError as error:
        print(f"TetGen refuses: {error}", file=sys.stderr)
        return 1
    print(len(tetrahedra))
    return 0


if __name__ == "__main__":
    sys.exit(main())
