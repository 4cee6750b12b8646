"""After the warm-up every kernel that Python calls is compiled, so no job waits for the compiler."""

from __future__ import annotations

import subprocess
import sys

LIST_COLD = """
import sys
from numba.core.registry import CPUDispatcher
from core.processes.warm_up import warm_up
warm_up()
packages = tuple(f"core.{name}" for name in ("geometry", "shells", "decimation", "smoothing", "healing"))
for module in [m for n, m in sys.modules.items() if n.startswith(packages)]:
    for name, kernel in vars(module).items():
        if isinstance(kernel, CPUDispatcher) and kernel.py_func.__module__ == module.__name__ and kernel.nopython_signatures:
            print(module.__name__, name)
"""


def test_kernels_are_warm():
    done = subprocess.run([sys.executable, "-c", LIST_COLD], capture_output=True, text=True, check=True)
    for kernel in ("_search", "_shift", "_shrink", "_spread", "_mark_own", "_mark_near", "choose_flips", "choose_collapses"):
        assert kernel in done.stdout
    for kernel in ("decimation.thin _drain", "decimation.literal _run", "decimation.smooth_near smooth_dirty"):
        assert kernel in done.stdout
    for kernel in ("healing.loop_triangulation _triangulate", "healing.local_crossings _mark"):
        assert kernel in done.stdout
