"""`python -m benchmarks.make_shells NAME SUBDIVISIONS FOLDER DEPTH...`: shells of one maker, timed in a process of their own.

Leaves `0.stl` (the outermost shell), ... in the folder and prints {"seconds", "peak_bytes"}.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from pathlib import Path

from benchmarks.makers import MAKERS, VARIANTS, warm_up
from core.io.registry import write_mesh
from subjects.body import body


def main() -> None:
    """Arguments as in the module's first line."""
    name, subdivisions, folder = sys.argv[1], int(sys.argv[2]), Path(sys.argv[3])
    depths = tuple(float(depth) for depth in sys.argv[4:])
    skin = body(subdivisions)
    maker = (MAKERS | VARIANTS)[name]
    warm_up(maker)
    start = time.perf_counter()
    shells = maker(skin, depths)
    seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    for row, shell in enumerate(shells):
        write_mesh(shell, folder / f"{row}.stl", "stl", f"layer_{row + 1}")
    print(json.dumps({"seconds": seconds, "peak_bytes": peak}))


if __name__ == "__main__":
    main()
