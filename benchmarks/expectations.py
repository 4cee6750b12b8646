"""What jobs really need, beside what `core.schema.expectation` expects: `python -m benchmarks.expectations`."""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from benchmarks.expectation_inputs import AVERAGE_BODY, FAT, POINTS, SKIN, TETRAHEDRA, Given, Inputs
from core.processes.registry import EventSink, run
from core.processes.registry import leisure_steps as leisure_steps
from core.processes.registry import warm_up as warm_up
from core.schema.expectation import expect
from core.schema.processes import PROCESSES
from core.schema.reference import CANONICAL_MEDIA_TYPE, FIELD_MEDIA_TYPE
from sandbox.limits import Limits
from sandbox.nursery import Nursery
from sandbox.outcome import Outcome

HERE = "benchmarks.expectations"
THREE = {"skin": {"href": SKIN}, "fat": {"href": FAT}, "average_body": {"href": AVERAGE_BODY}}
JOBS: tuple[tuple[str, str, Mapping[str, Any]], ...] = (
    ("validate", "", {"meshes": {"href": SKIN}}),
    ("shells", "2 layers", {"skin": {"href": SKIN}}),
    (
        "shells",
        "6 layers",
        {
            "skin": {"href": SKIN},
            "layers": [{"name": f"l{number}", "depth_mm": depth} for number, depth in enumerate((0.3, 0.6, 1, 2, 3, 5))],
        },
    ),
    ("ears", "2 layers", {"skin": {"href": SKIN}}),
    ("heal", "", {"mesh": {"href": SKIN}}),
    ("decimate", "to 1/4", {"mesh": {"href": SKIN}, "target_ratio": 0.25}),
    ("tetrahedralize", "", {"mesh": {"href": SKIN}}),
    ("tetrahedralize", "3 surfaces", {"meshes": THREE}),
    ("tetrahedralize", "3 surfaces, gmsh", {"meshes": THREE, "mesher": "gmsh"}),
    ("smooth", "along the surface", {"mesh": {"href": SKIN}, "method": "wcc", "along_surface": True}),
    ("fields", "1,000,000 points", {"mesh": {"href": SKIN}, "field": {"href": POINTS}, "max_distance_mm": 100.0}),
    ("fields", "995,328 tetrahedra", {"mesh": {"href": SKIN}, "field": {"href": TETRAHEDRA}}),
)


def measured(payload: dict[str, Any], channel: EventSink) -> dict[str, Any]:
    """The child's work, with the processor time it took, that of a mesher it starts included."""
    before = _cpu_s()
    result = run(payload, channel)
    cpu_s = _cpu_s() - before
    sizes = {output["name"]: Path(output["path"]).stat().st_size for output in result["outputs"]}
    return {"cpu_s": cpu_s, "sizes": sizes}


def _cpu_s() -> float:
    return sum(
        used.ru_utime + used.ru_stime for used in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    )


def measure(nursery: Nursery, process: str, inputs: Mapping[str, Any], given: Mapping[str, Given]) -> Outcome:
    """One job in a child of its own, as a worker runs it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "out").mkdir()
        meshes = {}
        for number, (href, one) in enumerate(given.items()):
            path = folder / f"{number}.in"
            path.write_bytes(one.path.read_bytes())
            meshes[href] = {
                "path": str(path),
                "name": f"surface_{number}",
                "sha256": "0" * 64,
                "media_type": FIELD_MEDIA_TYPE if href in (POINTS, TETRAHEDRA) else CANONICAL_MEDIA_TYPE,
                "file_name": "surface.stl",
            }
        payload = {"process": process, "inputs": dict(inputs), "meshes": meshes, "out_dir": str(folder / "out")}
        limits = Limits(forks=PROCESSES[process].starts_processes)
        with nursery.spawn(f"{HERE}:measured", payload, limits, folder) as child:
            while (outcome := child.outcome()) is None:
                child.events(0.2)
                child.memory_bytes()
        return outcome


def rows(levels: int, only: str | None) -> Iterator[tuple[str, ...]]:
    """One for each kind of job and size of the body."""
    nursery = Nursery((HERE,))
    nursery.start()
    try:
        with tempfile.TemporaryDirectory() as name:
            for level in range(levels):
                ready = Inputs(level, Path(name))
                for process, what, inputs in JOBS:
                    if only in (None, process):
                        yield _row(nursery, process, what, inputs, ready.of(inputs))
    finally:
        nursery.stop()


def _row(nursery: Nursery, process: str, what: str, inputs: Mapping[str, Any], given: Mapping[str, Given]) -> tuple[str, ...]:
    outcome = measure(nursery, process, inputs, given)
    stored = PROCESSES[process].inputs.model_validate(inputs).model_dump(mode="json")
    expected = expect(process, stored, sum(one.faces for one in given.values()))
    told = outcome.result or {}
    return (
        f"{process}, {what}".rstrip(", "),
        f"{given[SKIN].faces:,}",
        f"{outcome.peak_bytes / 1e6:.0f}",
        f"{expected.memory_bytes / 1e6:.0f}",
        f"{float(told.get('cpu_s', 0.0)):.1f}",
        f"{expected.cpu_s:.1f}",
        expected.queue,
        "" if outcome.error is None else outcome.error.code,
        str(told.get("sizes", "")),
    )


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(prog=f"python -m {HERE}", description=__doc__)
    parser.add_argument("--levels", type=int, default=2, help="bodies of 26,756, 107,024, 428,096 faces: how many of them")
    parser.add_argument("--only", choices=sorted(PROCESSES), help="one process")
    chosen = parser.parse_args()
    for row in rows(chosen.levels, chosen.only):
        print(" | ".join(row), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
