"""Tissues of a real head over HTTP: separated, proven, filled with tetrahedra; what cannot be is refused by name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from integument.cli import main

from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from core.validation.validate import validate
from subjects.head_tissues import coarse_head_tissues, layered_head_tissues
from tests.acceptance.service import Service, binary_stl, unpack_shells
from tests.embedded import Embedded
from tests.solids import sphere

GAP_MM = 0.1
LIMIT_S = 800.0  # the nine tissues take 20 s of processor time, on a machine with nothing else to do as many of the clock


def uploaded(service: Service, meshes: Mapping[str, Mesh]) -> dict[str, dict[str, str]]:
    return {name: {"href": service.upload(mesh, name)} for name, mesh in meshes.items()}


def separated(service: Service, meshes: Mapping[str, Mesh], **asked: Any) -> tuple[str, dict[str, Mesh]]:
    """The job, and the surfaces of its package."""
    job = service.execute("separate", {"meshes": uploaded(service, meshes), **asked})
    assert service.succeed(job, limit_s=LIMIT_S)["verdict"] == "simulation_ready"
    return job, unpack_shells(service.result(job, "package"))


def require_apart(before: Mapping[str, Mesh], after: Mapping[str, Mesh]) -> None:
    """All tissues, in one exact test and by measured gaps; vertices and faces are those that came."""
    assert set(after) == set(before)
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in after.values())])
    faces = np.concatenate([mesh.faces + np.int32(start) for mesh, start in zip(after.values(), starts, strict=False)])
    assert len(find_intersecting_faces(np.concatenate([mesh.vertices for mesh in after.values()]), faces)) == 0
    proof = validate(after, min_gap_mm=GAP_MM)
    assert proof.verdict == "simulation_ready"
    assert proof.nesting["white_left"] == "grey_left"
    assert {len(mesh.faces) for mesh in after.values()} == {len(mesh.faces) for mesh in before.values()}


def require_filled(service: Service, job: str, tissues: Mapping[str, Mesh]) -> None:
    """TetGen takes the package as it is, and finds as many regions as there are tissues."""
    filled = service.execute(
        "tetrahedralize", {"package": {"href": f"/v1/jobs/{job}/results/package"}, "radius_edge": None, "min_gap_mm": GAP_MM}
    )
    assert service.succeed(filled, limit_s=LIMIT_S)["verdict"] == "simulation_ready"
    regions = service.report(filled)["regions"]
    assert set(regions) == set(tissues)
    assert all(region["tetrahedra"] > 0 for region in regions.values())


def rows_of(service: Service, job: str) -> dict[str, dict[str, Any]]:
    """The report's row for each tissue."""
    (overview,) = [change for change in service.report(job)["changes"] if change.get("kind") == "separation"]
    return {row["tissue"]: row for row in overview["tissues"]}


def test_five_tissues_of_a_head(service: Service) -> None:
    before = coarse_head_tissues()
    job, after = separated(service, before, fixed=["skin"])
    require_apart(before, after)
    assert np.array_equal(after["skin"].triangles(), before["skin"].triangles())
    rows = rows_of(service, job)
    assert rows["skin"]["moved_vertices"] == 0
    assert all(rows[name]["moved_vertices"] > 0 for name in ("grey_left", "white_left", "grey_right"))
    page = service.http.get(f"/v1/jobs/{job}/report", headers={"Accept": "text/html"}).text
    assert "Where tissues were parted" in page
    require_filled(service, job, after)


def test_what_cannot_be_separated_is_refused_by_name(service: Service) -> None:
    balls = {"skin": sphere(5.0, 2), "organ": sphere(1.0, 2, at=(9.0, 0.0, 0.0)), "other": sphere(5.0, 2, at=(2.0, 0.0, 0.0))}
    links = uploaded(service, balls)
    refused: dict[str, dict[str, Any]] = {
        "separate.not_inside": {"meshes": {name: links[name] for name in ("skin", "organ")}, "inside": {"organ": "skin"}},
        "separate.unclear_sides": {"meshes": {name: links[name] for name in ("skin", "other")}},
        "separate.no_room": {
            "meshes": {name: links[name] for name in ("skin", "other")},
            "inside": {"skin": None, "other": None},
            "fixed": ["skin", "other"],
        },
    }
    for code, inputs in refused.items():
        ended = service.wait(service.execute("separate", inputs))
        assert ended["status"] == "failed"
        assert ended["failure"]["code"] == code
    reply = service.http.post("/v1/processes/separate/execution", json={"inputs": {"mesh": links["skin"]}})
    assert reply.status_code == 422
    assert "two or more" in reply.json()["detail"]


def test_from_the_command_line(server: Embedded, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INTEGUMENT_URL", server.url)
    files = {"left": sphere(5.0, 2), "right": sphere(5.0, 2, at=(9.5, 0.2, 0.1))}
    for name, mesh in files.items():
        (tmp_path / f"{name}.stl").write_bytes(binary_stl(mesh))
    package = tmp_path / "apart.zip"
    names = [str(tmp_path / f"{name}.stl") for name in files]
    assert main(["separate", *names, "--fixed", "left", "--min-gap", "0.2", "-o", str(package)]) == 0
    after = unpack_shells(package.read_bytes())
    assert validate(after, min_gap_mm=0.2).verdict == "simulation_ready"


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_nine_tissues_of_a_head_in_full(service: Service) -> None:
    before = layered_head_tissues()
    job, after = separated(service, before, fixed=["skin", "fat"])
    require_apart(before, after)
    rows = rows_of(service, job)
    assert len(rows) == 9
    assert rows["fat"]["moved_vertices"] == 0
    assert max(row["largest_shift_mm"] for row in rows.values()) < 0.5
    # where sheets coincide, each goes half of the gap; the skulls cross more deeply
    brain = [row for name, row in rows.items() if name.startswith(("grey", "white"))]
    assert all(0.3 * GAP_MM < row["mean_shift_mm"] < 0.7 * GAP_MM for row in brain)
    require_filled(service, job, after)
