"""TetGen in a process of its own: it ends the process when it gives up, which must not be that of the job.

`python -m core.tetrahedra.tetgen_program INPUT OUTPUT SWITCHES`; both files are .npz. Exit code 1 if TetGen says why.
"""

from __future__ import annotations

import sys

import numpy as np
import tetgen


def main(input_path: str, output_path: str, switches: str) -> int:
    """vertices (V, 3), faces (F, 3), points (N, 3), region (N,), largest (N,) mm³ -> nodes, tetrahedra, region."""
    with np.load(input_path, allow_pickle=False) as given:
        filler = tetgen.TetGen(given["vertices"], given["faces"])
        for number, point, largest in zip(given["region"], given["points"], given["largest"], strict=True):
            filler.add_region(int(number), tuple(point.tolist()), float(largest))
    try:
        nodes, tetrahedra, region, *_ = filler.tetrahedralize(switches=switches)
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 1
    with open(output_path, "wb") as output:
        np.savez(output, nodes=nodes, tetrahedra=tetrahedra, region=region.ravel())
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:4]))
