"""The jobs behind the thesis page, run by a server of its own over HTTP; what they gave is kept in out/thesis."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from integument import Client, EmbeddedServer

from core.io.registry import write_mesh
from core.mesh import Mesh
from core.package.read import read_shells
from subjects.body import body

SUBDIVISIONS = 1  # 107,024 faces
REQUESTS: Mapping[str, Mapping[str, Any]] = {
    "shells": {},  # the defaults are the thesis': fat 1 mm, average body 3 mm
    "ears": {"ears": "auto", "generate_canals": {}},  # 0.3 and 0.6 mm there
}


@dataclass(frozen=True, slots=True)
class Run:
    """One finished job. surfaces: as its package has them, skin first."""

    surfaces: Mapping[str, Mesh]
    report: Mapping[str, Any]


def thesis_runs(folder: Path) -> dict[str, Run]:
    """Process -> its run; made if the folder has none yet."""
    folder.mkdir(parents=True, exist_ok=True)
    if not all((folder / f"{process}.json").exists() for process in REQUESTS):
        _run_all(folder)
    return {
        process: Run(read_shells(folder / f"{process}.zip"), json.loads((folder / f"{process}.json").read_text()))
        for process in REQUESTS
    }


def _run_all(folder: Path) -> None:
    skin = folder / "skin.stl"
    write_mesh(body(SUBDIVISIONS), skin, "stl", "skin")
    with EmbeddedServer(folder / "data") as server, Client(server.url) as client:
        uploaded = client.upload_mesh(skin, unit="mm", name="skin")
        jobs = {
            process: client.execute(process, {"skin": {"href": uploaded.href}, **inputs}) for process, inputs in REQUESTS.items()
        }
        for process, job in jobs.items():
            done = client.wait(job)
            client.download(done, "package", folder / f"{process}.zip")
            (folder / f"{process}.json").write_text(json.dumps(client.report(done).as_json(), indent=1))
