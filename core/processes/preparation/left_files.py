"""What a job of `prepare` leaves however it ends: the surfaces as the last finished step left them, the record of the steps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from core.io.registry import write_mesh
from core.mesh import Mesh
from core.processes.outcome import OutputFile
from core.processes.preparation.step_log import StepLog
from core.run import RunContext

FOLDER = Path("left")
RECORD = OutputFile("steps", FOLDER / "steps.json", "application/json", "steps.json")


class LeftFiles:
    """Written after every step, each file as a whole: the process may be killed at any time."""

    def __init__(self, run: RunContext, out_dir: Path) -> None:
        self._run = run
        self._out_dir = out_dir
        self._written: dict[str, Mesh] = {}
        (out_dir / FOLDER).mkdir()

    def keep(self, log: StepLog) -> tuple[OutputFile, ...]:
        """Bring the files up to date and announce them."""
        files = (self.record(log), *(self._surface(name, mesh) for name, mesh in log.surfaces.items()))
        self._run.leave([file.listed(self._out_dir) for file in files])
        return files

    def record(self, log: StepLog) -> OutputFile:
        """The steps so far, with times."""
        told = log.records().model_dump_json(indent=2) + "\n"
        self._place(RECORD.path, lambda path: path.write_text(told, encoding="utf-8"))
        return RECORD

    def _surface(self, name: str, mesh: Mesh) -> OutputFile:
        file = OutputFile(name, FOLDER / f"{name}.stl", "model/stl", f"{name}.stl")
        if self._written.get(name) is not mesh:
            self._place(file.path, lambda path: write_mesh(mesh, path, "stl", name))
            self._written[name] = mesh
        return file

    def _place(self, path: Path, write: Callable[[Path], object]) -> None:
        half = self._out_dir / FOLDER / "half"
        write(half)
        half.replace(self._out_dir / path)
