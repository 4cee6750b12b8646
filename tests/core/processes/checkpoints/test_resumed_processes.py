"""Every process gives the same bytes whether its steps were made, all found, or found up to where the attempt before ended."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import pytest

from core.io import canonical
from core.mesh import Mesh
from core.processes.checkpoints.kept_steps import SUFFIX
from core.processes.registry import run
from tests.solids import sphere, together, without_faces

ROOM = 10**9
BOX = {"min": [35, -20, -20], "max": [65, 20, 20]}
TOP = [{"name": "top", "box_mm": {"min": [-100, -100, 20], "max": [100, 100, 100]}}]
SMALL, LARGE = sphere(50.0, 2), sphere(52.0, 2)
LAYERS = [{"name": "fat", "depth_mm": 1.0}, {"name": "average_body", "depth_mm": 3.0}, {"name": "core", "depth_mm": 6.0}]
OUTSIDE = {"name": "coat", "depth_mm": 2.0, "side": "outside"}


CASES: dict[str, tuple[str, dict[str, Mesh], dict[str, Any], int]] = {
    "shells": ("shells", {"skin": SMALL}, {"layers": [OUTSIDE, *LAYERS]}, 8),
    "ears": (
        "ears",
        {"skin": sphere(50.0, 4), "canal": sphere(4.0, 3, at=(50.0, 0.0, 0.0))},
        {"ears": [{"name": "tip", "box_mm": BOX}], "layers": LAYERS[:2]},
        6,
    ),
    "heal": ("heal", {"a": without_faces(SMALL, [3]), "b": LARGE}, {}, 4),
    "decimate": ("decimate", {"a": SMALL, "b": LARGE}, {"target_ratio": 0.5}, 4),
    "smooth": ("smooth", {"a": SMALL, "b": LARGE}, {"iterations": 2}, 3),
    "separate": ("separate", {"a": LARGE, "b": sphere(50.0, 2, at=(3.0, 0.0, 0.0))}, {}, 3),
    "graft": ("graft", {"base": LARGE, "donor": SMALL}, {"regions": TOP, "max_distance_mm": 5.0}, 2),
    "validate": ("validate", {"a": SMALL, "b": LARGE, "both": together(SMALL, LARGE)}, {}, 1),
}

QUICK = ("shells",)  # the others take a minute together


class Attempt:
    """One run of the registry, as a child would do it."""

    def __init__(self, folder: Path, case: str, kept: dict[str, Path] | None) -> None:
        process, meshes, asked, _ = CASES[case]
        entries, links = {}, {}
        folder.mkdir()
        for number, (name, mesh) in enumerate(meshes.items()):
            href = f"/v1/meshes/00000000-0000-0000-0000-{number:012d}"
            canonical.save(mesh, folder / f"{number}.mesh")
            entries[href] = {"path": str(folder / f"{number}.mesh"), "name": name, "sha256": f"{number:064d}"}
            links[name] = {"href": href}
        if process in ("heal", "decimate", "smooth", "separate", "validate"):
            links = {"meshes": links}
        if process == "ears":
            links["canals"] = [links.pop("canal")]
        (folder / "out").mkdir()
        payload = {"process": process, "inputs": {**links, **asked}, "meshes": entries, "out_dir": str(folder / "out")}
        if kept is not None:
            paths = {key: str(path) for key, path in kept.items()}
            payload["checkpoints"] = {"folder": str(folder), "kept": paths, "worth_s": 0.0, "room_bytes": ROOM}
        self.folder = folder
        self.made: dict[str, str] = {}
        self.taken: list[str] = []
        self.result = run(payload, self)
        self.bytes = {
            output["name"]: hashlib.sha256(Path(output["path"]).read_bytes()).hexdigest() for output in self.result["outputs"]
        }

    def send(self, message: dict[str, Any]) -> None:
        if message["kind"] == "checkpoint":
            self.made[message["key"]] = message["stage"]
        elif str(message["message"]).endswith("taken from the attempt before"):
            self.taken.append(str(message["message"]).partition(": taken")[0])

    def files(self) -> dict[str, Path]:
        return {key: self.folder / f"{key}{SUFFIX}" for key in self.made}


@pytest.mark.parametrize("case", [case if case in QUICK else pytest.param(case, marks=pytest.mark.slow) for case in CASES])
def test_a_resumed_attempt_gives_the_same_bytes(tmp_path: Path, case: str) -> None:
    plain = Attempt(tmp_path / "plain", case, None)
    first = Attempt(tmp_path / "first", case, {})
    assert len(first.made) == CASES[case][3], first.made
    assert first.taken == []
    again = Attempt(tmp_path / "again", case, first.files())
    assert again.made == {}
    assert again.taken == list(first.made.values())
    half = dict(list(first.files().items())[: len(first.made) // 2])
    rest = Attempt(tmp_path / "rest", case, half)
    assert len(rest.taken) == len(half)
    assert {**half, **rest.files()}.keys() == first.files().keys()
    assert plain.bytes == first.bytes == again.bytes == rest.bytes
    assert plain.result["verdict"] == again.result["verdict"]


def test_another_depth_shares_no_layer(tmp_path: Path) -> None:
    first = Attempt(tmp_path / "first", "shells", {})
    CASES["deeper"] = ("shells", {"skin": SMALL}, {"layers": [{"name": "fat", "depth_mm": 1.5}]}, 0)
    other = Attempt(tmp_path / "other", "deeper", first.files())
    assert "shells: layer" not in other.taken
