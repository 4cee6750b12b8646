"""`python -m tests.acceptance.tetgen_judge shells.npz`: is this a domain for TetGen? A crash ends this process only.

Prints {"nodes", "input", "tetrahedra"}; ends with an error if TetGen (`pYQ`: every facet kept, none split) refuses.
"""

import json
import sys

import numpy as np
import tetgen


def main() -> None:
    """Surfaces come as vertices_<i> and faces_<i>."""
    with np.load(sys.argv[1]) as arrays:
        count = len(arrays.files) // 2
        vertices = [arrays[f"vertices_{index}"] for index in range(count)]
        faces = [arrays[f"faces_{index}"] for index in range(count)]
    offsets = np.cumsum([0] + [len(points) for points in vertices])
    together = tetgen.TetGen(
        np.vstack(vertices), np.vstack([triangles + offset for triangles, offset in zip(faces, offsets, strict=False)])
    )
    nodes, tetrahedra, *_ = together.tetrahedralize(switches="pYQ")
    print(json.dumps({"nodes": len(nodes), "input": int(offsets[-1]), "tetrahedra": len(tetrahedra)}))


if __name__ == "__main__":
    main()
