"""What jobs really need, beside what `core.schema.expectation` expects: `python -m benchmarks.expectations`."""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from core.io import canonical
from core.processes.registry import EventSink, run
from core.processes.registry import leisure_steps as leisure_steps
from core.processes.registry import warm_up as warm_up
from core.schema.expectation import expect
from core.schema.processes import PROCESSES
from sandbox.limits import Limits
from sandbox.nursery import Nursery
from sandbox.outcome import Outcome
from subjects.body import body

HERE = "benchmarks.expectations"
SKIN, FAT = "/v1/meshes/00000000-0000-4000-8000-000000000001", "/v1/meshes/00000000-0000-4000-8000-000000000002"
EAR = {"min": [-100.0, 1450.0, -60.0], "max": [-55.0, 1600.0, 60.0]}
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
    ("smooth", "along the surface", {"mesh": {"href": SKIN}, "method": "wcc", "along_surface": True}),
)


def measured(payload: dict[str, Any], channel: EventSink) -> dict[str, Any]:
    """The child's work, with the processor time it took."""
    before = resource.getrusage(resource.RUSAGE_SELF)
    result = run(payload, channel)
    after = resource.getrusage(resource.RUSAGE_SELF)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    sizes = {output["name"]: Path(output["path"]).stat().st_size for output in result["outputs"]}
    return {"cpu_s": cpu_s, "sizes": sizes}


def measure(nursery: Nursery, process: str, inputs: Mapping[str, Any], mesh: Path) -> Outcome:
    """One job in a child of its own, as a worker runs it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "out").mkdir()
        (folder / "in.mesh").write_bytes(mesh.read_bytes())
        told = {
            "path": str(folder / "in.mesh"),
            "name": "skin",
            "sha256": "0" * 64,
            "media_type": "application/x-integument-mesh",
            "file_name": "skin.stl",
        }
        payload = {"process": process, "inputs": dict(inputs), "meshes": {SKIN: told}, "out_dir": str(folder / "out")}
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
                mesh, path = body(level), Path(name) / f"{level}.mesh"
                canonical.save(mesh, path)
                for process, what, inputs in JOBS:
                    if only not in (None, process):
                        continue
                    outcome = measure(nursery, process, inputs, path)
                    faces = len(mesh.faces)
                    expected = expect(process, PROCESSES[process].inputs.model_validate(inputs).model_dump(mode="json"), faces)
                    told = outcome.result or {}
                    cpu_s = float(told.get("cpu_s", 0.0))
                    yield (
                        f"{process} {what}".strip(),
                        f"{faces:,}",
                        f"{outcome.peak_bytes / 1e6:.0f}",
                        f"{expected.memory_bytes / 1e6:.0f}",
                        f"{cpu_s:.1f}",
                        f"{expected.cpu_s:.1f}",
                        expected.queue,
                        "" if outcome.error is None else outcome.error.code,
                        str(told.get("sizes", "")),
                    )
    finally:
        nursery.stop()


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
