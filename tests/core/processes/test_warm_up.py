"""After all steps of the warm-up every kernel that Python calls is compiled, so no job waits for the compiler."""

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


REHEARSE = """
import os, tempfile
folder = tempfile.mkdtemp()
os.environ["TMPDIR"] = tempfile.tempdir = folder
from core.processes.rehearsal import rehearse
from core.processes.registry import run
seen = []
def watched(payload, channel):
    run(payload, channel)
    seen.extend(name for name in os.listdir(payload["out_dir"]) if name == "report.html")
rehearse(watched)
print("left:", len([name for name in os.listdir(folder) if name.startswith("itg-rehearsal")]), "report:", len(seen))
os.rmdir(folder) if not os.listdir(folder) else None
"""


def test_a_whole_job_is_rehearsed_and_leaves_nothing():
    done = subprocess.run([sys.executable, "-c", REHEARSE], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["left:", "0", "report:", "1"]
