"""One whole job before the first: whatever is loaded or drawn for the first time then, every child has from its parent.

The first report of a process takes a third longer than those that follow, and the child of a job writes only one."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from core.io import canonical
from core.mesh import Mesh
from core.processes.warm_up import CUBE_CORNERS, CUBE_FACES

HREF = "/v1/meshes/00000000-0000-4000-8000-000000000000"


class Nobody:
    """Hears the progress of the rehearsal."""

    def send(self, message: dict[str, Any]) -> None:
        """Forgotten at once."""


def rehearse(run: Callable[[dict[str, Any], Nobody], object]) -> None:
    """Let `run` validate a cube, in a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory(prefix="itg-rehearsal-") as name:
        mesh = Path(name) / "cube.mesh"
        canonical.save(Mesh.of(CUBE_CORNERS, CUBE_FACES), mesh)
        entry = {"path": str(mesh), "name": "cube", "sha256": "0" * 64, "file_name": "cube.stl"}
        run({"process": "validate", "inputs": {"meshes": {"href": HREF}}, "meshes": {HREF: entry}, "out_dir": name}, Nobody())
