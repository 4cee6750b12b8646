"""The same job without any service: read, check, draw and write in one warm process. `python -m benchmarks.load.bare N`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

HREF = "/v1/meshes/00000000-0000-4000-8000-000000000000"
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


@dataclass(frozen=True, slots=True)
class Bare:
    """Means of one job. check_s: of its wall time, what reading and checking take; the rest is the report and its figures."""

    wall_s: float
    cpu_s: float
    check_s: float


def measure_bare(jobs: int) -> Bare:
    """In a process of its own, with as many threads as a job's child."""
    command = [sys.executable, "-m", "benchmarks.load.bare", str(jobs)]
    ran = subprocess.run(command, check=True, stdout=subprocess.PIPE, env={**os.environ, **ONE_THREAD})
    return Bare(**json.loads(ran.stdout.splitlines()[-1]))


class _Clock:
    """Takes the place of the channel; notes when the report begins."""

    def __init__(self) -> None:
        self.began = time.perf_counter()
        self.checked_s = 0.0

    def send(self, message: dict[str, Any]) -> None:
        """Hear one event of the job."""
        if message["phase"] == "figures" and not self.checked_s:
            self.checked_s = time.perf_counter() - self.began


def main() -> None:
    """One line of JSON, after one job that warms up."""
    from core.io import canonical
    from core.processes.registry import run, warm_up
    from tests.solids import cube

    warm_up()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        canonical.save(cube(100.0), folder / "cube.mesh")
        entry = {"path": str(folder / "cube.mesh"), "name": "cube", "sha256": "0" * 64, "file_name": "cube.stl"}
        payload = {"process": "validate", "inputs": {"meshes": {"href": HREF}}, "meshes": {HREF: entry}, "out_dir": name}
        run(payload, _Clock())
        jobs = int(sys.argv[1])
        began, busy, checked_s = time.perf_counter(), time.process_time(), 0.0
        for _ in range(jobs):
            clock = _Clock()
            run(payload, clock)
            checked_s += clock.checked_s
        bare = Bare((time.perf_counter() - began) / jobs, (time.process_time() - busy) / jobs, checked_s / jobs)
    print(json.dumps(asdict(bare)))


if __name__ == "__main__":
    main()
