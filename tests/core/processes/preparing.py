"""Jobs of `prepare` without a server: an attempt as a child would make it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.io import canonical
from core.mesh import Mesh
from core.processes.checkpoints.kept_steps import SUFFIX
from core.processes.registry import run
from core.schema.report import Report
from tests.solids import sphere, without_faces

ROOM = 10**9
SKIN = without_faces(sphere(50.0, 4), [3])
TIP = {"name": "tip", "box_mm": {"min": [35, -20, -20], "max": [65, 20, 20]}}
CANAL = sphere(4.0, 3, at=(50.0, 0.0, 0.0))
BRAIN, WHITE, EYE = sphere(20.0, 3), sphere(10.0, 3), sphere(8.0, 3, at=(0.0, 0.0, 27.9))  # it crosses the brain


class Attempt:
    """One attempt; meshes: name -> mesh, `skin`, `canal` or an inner tissue. kept: steps of attempts before."""

    def __init__(self, folder: Path, meshes: Mapping[str, Mesh], kept: Mapping[str, Path] | None = None, **asked: Any) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        entries, links = {}, {}
        for number, (name, mesh) in enumerate(meshes.items()):
            href = f"/v1/meshes/00000000-0000-0000-0000-{number:012d}"
            canonical.save(mesh, folder / f"{number}.mesh")
            entries[href] = {"path": str(folder / f"{number}.mesh"), "name": name, "sha256": f"{number:064d}"}
            links[name] = {"href": href}
        said = asked.pop("said", {})
        inputs = {"skin": links.pop("skin"), **asked}
        if "canal" in links:
            inputs["canals"] = [links.pop("canal")]
        if links:
            inputs["tissues"] = [{"name": name, "mesh": link, **said.get(name, {})} for name, link in links.items()]
        self.folder, self.out = folder, folder / "out"
        self.out.mkdir()
        self.made: dict[str, str] = {}
        self.log: list[str] = []
        self.left: list[dict[str, Path]] = []  # by name, after every step
        self._payload = {"process": "prepare", "inputs": inputs, "meshes": entries, "out_dir": str(self.out)}
        if kept is not None:
            paths = {key: str(path) for key, path in kept.items()}
            self._payload["checkpoints"] = {"folder": str(folder), "kept": paths, "worth_s": 0.0, "room_bytes": ROOM}

    def run(self) -> dict[str, Any]:
        """The result; raises what the job fails of."""
        result = run(self._payload, self)
        return {**result, "files": {output["name"]: Path(output["path"]) for output in result["outputs"]}}

    def send(self, message: dict[str, Any]) -> None:
        """Takes what a worker would hear."""
        if message["kind"] == "checkpoint":
            self.made[message["key"]] = message["stage"]
        elif message["kind"] == "left":
            self.left.append({output["name"]: Path(output["path"]) for output in message["outputs"]})
        elif message["kind"] == "log":
            self.log.append(str(message["message"]))

    def kept(self) -> dict[str, Path]:
        """The steps it finished, for the next attempt."""
        return {key: self.folder / f"{key}{SUFFIX}" for key in self.made}


def report_in(folder: Path) -> Report:
    """The report of a job that succeeded or failed."""
    return Report.model_validate_json((folder / "report.json").read_bytes())
