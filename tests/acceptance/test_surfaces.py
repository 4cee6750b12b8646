"""From a defective body to nested shells with a quarter of the faces, over HTTP by links alone, and refusals by name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from integument.cli import main

from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from subjects.body import body
from subjects.defects import CORPUS
from tests.acceptance.conftest import MainJob
from tests.acceptance.service import Service, binary_stl, read_stl, unpack_shells
from tests.embedded import Embedded
from tests.solids import sphere, together, without_faces

DEFECTIVE = "body, faces missing + triangle soup"
FACE = {"name": "face", "box_mm": {"min": [-80, 620, 0], "max": [80, 780, 160]}, "ratio": 1.0}


def faces_in_face(mesh: Mesh) -> set[bytes]:
    """The corners of the faces well inside the region, whichever comes first."""
    corners = mesh.triangles()
    inside = ((corners > np.array(FACE["box_mm"]["min"]) + 8) & (corners < np.array(FACE["box_mm"]["max"]) - 8)).all(axis=(1, 2))
    return {np.sort(face.view("f8,f8,f8").ravel(), order=["f0", "f1", "f2"]).tobytes() for face in corners[inside] + 0.0}


def test_heal_decimate_shells_by_links_alone(service: Service) -> None:
    (entry,) = [entry for entry in CORPUS if entry.name == DEFECTIVE]
    broken = service.upload(entry.make(), "broken")
    healing = service.execute("heal", {"mesh": {"href": broken}})
    assert service.succeed(healing)["verdict"] == "simulation_ready"
    told = service.report(healing)
    assert told["changes"]
    assert told["comparisons"]["mesh"]["before"]["closed"] is False

    healed = {"href": f"/v1/jobs/{healing}/results/mesh"}
    thinning = service.execute("decimate", {"mesh": healed, "target_ratio": 0.5, "regions": [FACE]})
    assert service.succeed(thinning)["verdict"] == "simulation_ready"
    thin, whole = (read_stl(service.result(job, "mesh")) for job in (thinning, healing))
    assert len(find_intersecting_faces(thin.vertices, thin.faces)) == 0
    assert len(thin.faces) < 0.7 * len(whole.faces)
    kept = faces_in_face(whole)
    assert len(kept) > 500
    assert kept <= faces_in_face(thin)

    job = service.shells(f"/v1/jobs/{thinning}/results/mesh")
    assert service.succeed(job)["verdict"] == "simulation_ready"


def test_a_package_is_thinned_as_a_whole(service: Service, main_job: MainJob) -> None:
    package = {"href": f"/v1/jobs/{main_job.job}/results/package"}
    job = service.execute("decimate", {"package": package, "target_ratio": 0.4})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    thin = unpack_shells(service.result(job, "package"))
    assert list(thin) == list(main_job.shells)
    for name, mesh in thin.items():
        assert len(mesh.faces) <= 0.4 * len(main_job.shells[name].faces) + 1
        assert np.array_equal(read_stl(service.result(job, name)).triangles(), mesh.triangles())
    # all three in one exact test: neither crosses itself nor another
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in thin.values())])
    faces = np.concatenate([mesh.faces + np.int32(start) for mesh, start in zip(thin.values(), starts, strict=False)])
    assert len(find_intersecting_faces(np.concatenate([mesh.vertices for mesh in thin.values()]), faces)) == 0
    proof = service.execute(
        "validate", {"meshes": {name: {"href": f"/v1/jobs/{job}/results/{name}"} for name in thin}, "min_gap_mm": 0.05}
    )
    assert service.succeed(proof)["verdict"] == "simulation_ready"
    assert service.report(proof)["nesting"] == {"skin": None, "fat": "skin", "average_body": "fat"}

    again = service.execute("smooth", {"package": {"href": f"/v1/jobs/{job}/results/package"}, "iterations": 3})
    assert service.succeed(again)["verdict"] == "simulation_ready"


def test_smoothing_of_the_body_tells_what_it_cost(service: Service, skin: str) -> None:
    job = service.execute("smooth", {"mesh": {"href": skin}, "method": "wcc", "along_surface": True, "iterations": 10})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    told = service.report(job)
    compared = told["comparisons"]["mesh"]
    assert told["meshes"]["mesh"]["quality"]["minimum"] > compared["before"]["quality"]["minimum"]
    assert abs(compared["volume_change"]) < 0.005
    page = service.http.get(f"/v1/jobs/{job}/report", headers={"Accept": "text/html"}).text
    assert "Quality by iteration" in page


def refusal(service: Service, process: str, inputs: dict[str, Any]) -> dict[str, Any]:
    """The problem document of an execution that is not accepted."""
    reply = service.http.post(f"/v1/processes/{process}/execution", json={"inputs": inputs})
    assert reply.status_code == 422, reply.text
    problem: dict[str, Any] = reply.json()
    return problem


HALF = {"target_ratio": 0.5}
CONTRADICTIONS: dict[str, tuple[str, dict[str, Any], str]] = {
    "no target": ("decimate", {}, "none"),
    "two targets": ("decimate", {**HALF, "target_faces": 1000}, "target_faces and target_ratio"),
    "a ratio above 1": ("decimate", {"target_ratio": 1.5}, "1.5"),
    "no faces": ("decimate", {"target_faces": 0}, "got 0"),
    "deviation below 0": ("decimate", {"max_deviation_mm": -1}, "-1"),
    "literal with quadrics": ("decimate", {**HALF, "literal": True, "method": "quadric"}, "literal"),
    "regions of one name": ("decimate", {**HALF, "regions": [FACE, FACE]}, "different names"),
    "another method's parameter": ("smooth", {"method": "wcc", "taubin_mu": -0.6}, "taubin_mu"),
    "Taubin without a step out": ("smooth", {"method": "taubin", "taubin_mu": -0.1}, "taubin_mu"),
    "no iterations": ("smooth", {"iterations": 0}, "got 0"),
    "a policy nobody knows": ("heal", {"pieces": "keep_nicest"}, "keep_nicest"),
    "more than everything": ("heal", {"max_volume_change": 2}, "got 2"),
}


@pytest.mark.parametrize("case", CONTRADICTIONS)
def test_contradictions_are_refused_at_once(case: str, service: Service, skin: str) -> None:
    process, inputs, words = CONTRADICTIONS[case]
    problem = refusal(service, process, {"mesh": {"href": skin}, **inputs})
    assert problem["code"] == "inputs.invalid"
    assert words in problem["detail"]


def test_exactly_one_subject(service: Service, skin: str, main_job: MainJob) -> None:
    package = {"href": f"/v1/jobs/{main_job.job}/results/package"}
    for subjects in ({}, {"mesh": {"href": skin}, "package": package}, {"meshes": {}}, {"meshes": {"report": {"href": skin}}}):
        assert refusal(service, "heal", subjects)["code"] == "inputs.invalid"


def test_what_is_no_package_is_refused_at_once(service: Service, skin: str, main_job: MainJob) -> None:
    results = f"/v1/jobs/{main_job.job}/results"
    assert refusal(service, "heal", {"package": {"href": skin}})["code"] == "inputs.invalid"  # an upload is never one
    assert refusal(service, "heal", {"package": {"href": f"{results}/skin"}})["code"] == "reference.not_a_package"
    assert refusal(service, "heal", {"package": {"href": f"{results}/report"}})["code"] == "reference.not_a_package"
    assert refusal(service, "heal", {"mesh": {"href": f"{results}/package"}})["code"] == "reference.not_a_mesh"


FAR = {"name": "nowhere", "box_mm": {"min": [900, 0, 0], "max": [950, 50, 50]}}
HOLED = without_faces(sphere(50, 2), range(9))
LINE = Mesh.of([(0, 0, 0), (50, 0, 0), (100, 0, 0)], [(0, 1, 2)])
HOPELESS: dict[str, tuple[str, Mesh, dict[str, Any], str]] = {
    "region off the mesh, decimate": (
        "decimate",
        sphere(50, 2),
        {**HALF, "regions": [{**FAR, "ratio": 1}]},
        "region.outside_mesh",
    ),
    "region off the mesh, smooth": ("smooth", sphere(50, 2), {"regions": [FAR]}, "region.outside_mesh"),
    "open": ("decimate", without_faces(sphere(50, 2), [0]), HALF, "surface.not_closed"),
    "crossing": ("smooth", together(sphere(50, 2), sphere(50, 2, at=(31, 7, 3))), {}, "surface.self_intersecting"),
    "a line": ("heal", LINE, {}, "heal.nothing_left"),
    "hole, but none may be filled": (
        "heal",
        HOLED,
        {"fill_holes": False},
        "heal.holes_not_allowed",
    ),
    "hole too large": ("heal", HOLED, {"max_hole_mm": 1}, "heal.hole_too_large"),
}


@pytest.mark.parametrize("case", HOPELESS)
def test_what_cannot_be_done_fails_by_name_and_says_why(case: str, service: Service) -> None:
    process, mesh, inputs, code = HOPELESS[case]
    job = service.execute(process, {"mesh": {"href": service.upload(mesh, "hopeless")}, **inputs})
    status = service.wait(job)
    assert status["status"] == "failed", status
    assert (status["failure"]["code"], status["failure"]["class"]) == (code, "input")
    told = service.report(job)
    assert told["verdict"] == "not_ready"
    assert told["summary"] == status["failure"]["message"]


def test_a_target_below_topology_gives_what_topology_allows(service: Service) -> None:
    job = service.execute("decimate", {"mesh": {"href": service.upload(body(0), "body")}, "target_faces": 4})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    told = service.report(job)
    assert 4 <= told["meshes"]["mesh"]["faces"] < 4000
    assert any(finding["code"].startswith("decimate.") for finding in told["findings"])


def test_the_command_line_thins_a_body_and_a_package_on_disk(
    server: Embedded, main_job: MainJob, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("INTEGUMENT_URL", server.url)
    (tmp_path / "skin.stl").write_bytes(binary_stl(body(0)))
    (tmp_path / "package.zip").write_bytes(main_job.package)
    thin, report = tmp_path / "out.stl", tmp_path / "report.html"
    assert main(["decimate", str(tmp_path / "skin.stl"), "--ratio", "0.25", "-o", str(thin), "--report", str(report)]) == 0
    assert "26,756 → 6," in capsys.readouterr().out
    assert len(read_stl(thin.read_bytes()).faces) <= 6_689
    assert "Before and after" in report.read_text(encoding="utf-8")
    healed = tmp_path / "healed.zip"
    assert main(["heal", str(tmp_path / "package.zip"), "-o", str(healed)]) == 0
    shells = unpack_shells(healed.read_bytes())
    assert set(shells) == set(main_job.shells)
    assert all(np.array_equal(mesh.triangles(), main_job.shells[name].triangles()) for name, mesh in shells.items())
