"""The jobs behind the thesis page, run by a server of its own over HTTP; what they gave is kept in out/thesis."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from integument import Client, EmbeddedServer

from core.io.registry import read_meshes, write_mesh
from core.mesh import Mesh
from core.package.read import read_shells
from subjects.body import body
from subjects.touching import arms_lowered, grown_together


@dataclass(frozen=True, slots=True)
class Request:
    """One job. gives: the output that is kept, a package or the skin."""

    skin: Callable[[], Mesh]
    inputs: Mapping[str, Any]
    gives: str = "package"


@dataclass(frozen=True, slots=True)
class Run:
    """One finished job. before: the skin it was given. surfaces: as its output has them, skin first."""

    before: Mesh
    surfaces: Mapping[str, Mesh]
    report: Mapping[str, Any]


ARMPITS = ((60, 330, -60), (240, 450, 90)), ((-240, 330, -60), (-60, 450, 90))
REQUESTS: Mapping[str, Request] = {
    # the defaults are the thesis': fat 1 mm, average body 3 mm
    "shells": Request(lambda: body(1), {}),
    # 0.3 and 0.6 mm in the ears
    "ears": Request(lambda: body(1), {"ears": "auto", "generate_canals": {}}),
    "detach": Request(
        lambda: grown_together(arms_lowered(40.0)),
        {
            "regions": [
                {"name": f"armpit_{side}", "box_mm": {"min": low, "max": high}} for side, (low, high) in enumerate(ARMPITS)
            ]
        },
        "skin",
    ),
}


def thesis_runs(folder: Path) -> dict[str, Run]:
    """Process -> its run; those the folder has not got are made."""
    folder.mkdir(parents=True, exist_ok=True)
    missing = [process for process in REQUESTS if not (folder / f"{process}.json").exists()]
    if missing:
        _run(missing, folder)
    return {process: _read(process, folder) for process in REQUESTS}


def _run(processes: list[str], folder: Path) -> None:
    with EmbeddedServer(folder / "data") as server, Client(server.url) as client:
        for process in processes:
            request = REQUESTS[process]
            write_mesh(request.skin(), folder / f"{process}-before.stl", "stl", "skin")
            uploaded = client.upload_mesh(folder / f"{process}-before.stl", unit="mm", name="skin")
            done = client.wait(client.execute(process, {"skin": {"href": uploaded.href}, **request.inputs}))
            client.download(done, request.gives, _kept(process, folder))
            (folder / f"{process}.json").write_text(json.dumps(client.report(done).as_json(), indent=1))


def _read(process: str, folder: Path) -> Run:
    path = _kept(process, folder)
    surfaces = read_shells(path) if path.suffix == ".zip" else {"skin": _read_stl(path)}
    report = json.loads((folder / f"{process}.json").read_text())
    return Run(_read_stl(folder / f"{process}-before.stl"), surfaces, report)


def _read_stl(path: Path) -> Mesh:
    return read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh


def _kept(process: str, folder: Path) -> Path:
    return folder / f"{process}.{'zip' if REQUESTS[process].gives == 'package' else 'stl'}"
