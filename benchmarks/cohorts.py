"""How a cohort scales over worker processes: `python -m benchmarks.cohorts`, on a machine that does nothing else.

Every run has a fresh lab (PostgreSQL, Valkey, object store) whose workers do one job at a time; a first cohort, for which they
load libraries and kernels, is not counted. Compared is the time from the acceptance to the end of the last subject."""

from __future__ import annotations

import argparse
import sys
import time
from contextlib import closing
from datetime import datetime

from benchmarks.load.stand import Stand, stand
from benchmarks.table import print_table
from tests.acceptance.service import Service
from tests.solids import sphere

SUBJECTS, WORKERS = 100, (1, 2)
SUBDIVISIONS = 3  # 1,280 faces
PROMISED = 1.8
LOOK_S, LIMIT_S = 0.5, 3600.0


def main() -> int:
    """Exit code 1 if a subject is missing, or two workers are not 1.8 times as fast as one."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cohorts", description=__doc__)
    parser.add_argument("--subjects", type=int, default=SUBJECTS, help="of the cohort that is timed")
    chosen = parser.parse_args()
    rows, took_s = [], {}
    for workers in WORKERS:
        with stand("lab", hosts=workers) as there:
            took_s[workers], cpu_s = _time(there, workers, chosen.subjects)
        speed = took_s[WORKERS[0]] / took_s[workers]
        rows.append((str(workers), f"{took_s[workers]:.1f}", f"{cpu_s / chosen.subjects:.2f}", f"{speed:.2f}"))
    print_table(
        f"{chosen.subjects} subjects, `validate`", ("workers", "s", "CPU s per subject, all processes", "times as fast"), rows
    )
    return 0 if took_s[1] / took_s[2] >= PROMISED else 1


def _time(there: Stand, workers: int, subjects: int) -> tuple[float, float]:
    """Seconds from acceptance to the end of the last subject, and processor time of everything meanwhile."""
    with closing(Service(there.url, there.headers.get("Authorization", "").removeprefix("Bearer "))) as service:
        meshes = [service.upload(sphere(50.0 + number, SUBDIVISIONS), f"s{number}") for number in range(subjects)]
        _run(service, meshes[: 4 * workers])
        before = there.cpu_s()
        seconds = _run(service, meshes)
        return seconds, there.cpu_s() - before


def _run(service: Service, meshes: list[str]) -> float:
    subjects = [{"name": f"s{number}", "mesh": {"href": href}} for number, href in enumerate(meshes)]
    reply = service.http.post("/v1/cohorts", json={"process": "validate", "subjects": subjects})
    reply.raise_for_status()
    deadline = time.monotonic() + LIMIT_S
    while (told := service.http.get(reply.headers["Location"]).json())["status"] != "finished":
        if time.monotonic() > deadline:
            raise TimeoutError(str(told))
        time.sleep(LOOK_S)
    if told["ready"] != len(meshes):
        raise RuntimeError(f"{told['ready']} of {len(meshes)} subjects are ready: {told}")
    return (datetime.fromisoformat(told["finished"]) - datetime.fromisoformat(told["created"])).total_seconds()


if __name__ == "__main__":
    sys.exit(main())
