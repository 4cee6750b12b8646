"""How a cohort scales over worker processes: `python -m benchmarks.cohorts`, on a machine that does nothing else.

Every run has a fresh lab (PostgreSQL, Valkey, object store) whose workers do one job at a time; a first cohort, for which they
load libraries and kernels, is not counted. Compared is the time from the acceptance to the end of the last subject. Processor
time is told by part: what is not the workers' own is done beside them, on a core that one worker leaves idle and two do not.
What API and servers do for a subject hardly depends on its size, so the share of it, and what can be reached on two cores,
does: `--subdivisions` says how many faces a subject has. The default is small for a surface of a body."""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import time
from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime

import psutil

from benchmarks.load.stand import Stand, cpu_s_of, stand
from benchmarks.table import print_table
from core.mesh import Mesh
from tests.acceptance.service import Service
from tests.solids import sphere

SUBJECTS, WORKERS, ROUNDS = 100, (1, 2), 3
SUBDIVISIONS = 4
PROCESSES = {"validate": {}, "shells": {"layers": [{"name": "fat", "depth_mm": 1.0}, {"name": "average_body", "depth_mm": 3.0}]}}
PROMISED = 1.8
LOOK_S, LIMIT_S = 0.5, 3600.0


@dataclass(frozen=True, slots=True)
class Course:
    """Medians over the rounds: seconds until the last subject had ended, and processor seconds by part meanwhile."""

    seconds: float
    workers_cpu_s: float
    api_cpu_s: float
    others_cpu_s: float

    @property
    def cpu_s(self) -> float:
        """Of all parts."""
        return self.workers_cpu_s + self.api_cpu_s + self.others_cpu_s


def main() -> int:
    """Exit code 1 if a subject is missing, or two workers are not 1.8 times as fast as one."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.cohorts", description=__doc__)
    parser.add_argument("--subjects", type=int, default=SUBJECTS, help="of the cohort that is timed")
    parser.add_argument(
        "--process", choices=PROCESSES, default="shells", help="shells keep the processor busy, validate is told fast"
    )
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="cohorts that are timed, one after the other")
    parser.add_argument(
        "--subdivisions", type=int, default=SUBDIVISIONS, help="of a subject: 3 are 512 faces, 4 are 2,048, 5 are 8,192"
    )
    chosen = parser.parse_args()
    courses = {}
    for workers in WORKERS:
        with stand("lab", hosts=workers) as there:
            spheres = [sphere(50.0 + number, chosen.subdivisions) for number in range(chosen.subjects)]
            courses[workers] = _time(there, workers, chosen.process, spheres, chosen.rounds)
    one, two = (courses[workers] for workers in WORKERS)
    print_table(
        f"{chosen.subjects} subjects of {len(spheres[0].faces):,} faces, `{chosen.process}`, median of {chosen.rounds}",
        (
            "workers",
            "s",
            "times as fast",
            *(f"CPU ms per subject: {part}" for part in ("workers", "API", "database, broker, blobs")),
        ),
        [_row(workers, course, one, chosen.subjects) for workers, course in courses.items()],
    )
    beside = 1.0 - two.workers_cpu_s / two.cpu_s
    print(f"API and servers take {beside:.1%} of all processor time with two workers.")
    most = one.seconds * (os.cpu_count() or 1) / two.cpu_s
    print(f"{os.cpu_count()} cores could do it {most:.2f} times as fast as one worker, were nobody ever waiting.")
    return 0 if one.seconds / two.seconds >= PROMISED else 1


def _row(workers: int, course: Course, one: Course, subjects: int) -> tuple[str, ...]:
    parts = (course.workers_cpu_s, course.api_cpu_s, course.others_cpu_s)
    return (
        str(workers),
        f"{course.seconds:.1f}",
        f"{one.seconds / course.seconds:.2f}",
        *(f"{1000 * part / subjects:.0f}" for part in parts),
    )


def _time(there: Stand, workers: int, process: str, subjects: Sequence[Mesh], rounds: int) -> Course:
    with closing(Service(there.url, there.headers.get("Authorization", "").removeprefix("Bearer "))) as service:
        meshes = [service.upload(subject, f"s{number}") for number, subject in enumerate(subjects)]
        _run(service, process, meshes[: 4 * workers])
        seen = [_course(there, service, process, meshes) for _ in range(rounds)]
    return Course(*(statistics.median(values) for values in zip(*seen, strict=True)))


def _course(there: Stand, service: Service, process: str, meshes: list[str]) -> tuple[float, float, float, float]:
    before = [_cpu_s(part) for part in (there.workers, (there.api,), there.others)]
    seconds = _run(service, process, meshes)
    after = [_cpu_s(part) for part in (there.workers, (there.api,), there.others)]
    worked, asked, kept = (end - start for start, end in zip(before, after, strict=True))
    return seconds, worked, asked, kept


def _cpu_s(part: Iterable[psutil.Process]) -> float:
    return sum(map(cpu_s_of, part))


def _run(service: Service, process: str, meshes: list[str]) -> float:
    subjects = [{"name": f"s{number}", "mesh": {"href": href}} for number, href in enumerate(meshes)]
    asked = {"process": process, "inputs": PROCESSES[process], "subjects": subjects}
    reply = service.http.post("/v1/cohorts", json=asked)
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
