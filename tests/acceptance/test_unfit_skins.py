"""Geometry that is found unfit only while running: the job fails, says whose fault it is, and names faces."""

from dataclasses import dataclass, field
from html import unescape
from typing import Any

import numpy as np
import pytest

from core.mesh import Mesh
from core.reports.prose import headline, sentence
from subjects.body import body
from tests.acceptance.service import Service
from tests.solids import flipped, sphere, together, without_faces

BALL = sphere(100.0, 4)  # 2,048 faces


def dented(mesh: Mesh) -> Mesh:
    """One vertex pulled through the opposite side."""
    vertices = mesh.vertices.copy()
    vertices[0] = -1.3 * vertices[0]
    return Mesh.of(vertices, mesh.faces)


@dataclass(frozen=True)
class Case:
    """A skin, what is asked of it, and the code of the refusal."""

    code: str
    skin: Mesh
    inputs: dict[str, Any] = field(default_factory=dict)


CASES = {
    "open": Case("skin.not_closed", without_faces(BALL, [7, 8])),
    "inside out": Case("skin.inside_out", flipped(BALL)),
    "partly turned": Case("skin.not_oriented", flipped(BALL, [3, 4, 5])),
    "two bodies": Case("skin.several_bodies", together(BALL, sphere(50.0, 3, at=(300.0, 0.0, 0.0)))),
    "through itself": Case("skin.self_intersecting", dented(BALL)),
    "deeper than any reach": Case("layer.deeper_than_reach", sphere(20.0, 3), {"layers": [{"name": "deep", "depth_mm": 60.0}]}),
    "thin, and not allowed to adapt": Case("skin.too_thin", body(0), {"thin_policy": "fail"}),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_unfit_skin_fails_with_faces_and_a_report(service: Service, case: Case) -> None:
    job = service.shells(service.upload(case.skin), **case.inputs)
    ended = service.wait(job)
    assert ended["status"] == "failed"
    assert ended["failure"]["class"] == "input"
    assert ended["failure"]["retryable"] is False
    assert ended["failure"]["code"] == case.code
    assert ended["attempt"] == 1

    report = service.report(job)
    assert report["verdict"] == "not_ready"
    places = [place for finding in report["findings"] for place in finding["places"]]
    named = {face for place in places for face in place["faces"]}
    assert named
    assert named < set(range(len(case.skin.faces)))
    assert all(np.isfinite(place["point_mm"]).all() for place in places)

    page = service.http.get(f"/v1/jobs/{job}/report", headers={"Accept": "text/html"})
    assert page.status_code == 200
    reason, rest = headline(report["summary"])
    assert f'<span class="reason">{reason}</span>' in unescape(page.text)
    assert sentence(rest, {"skin"}) in unescape(page.text)

    refusal = service.http.get(f"/v1/jobs/{job}/results")
    assert refusal.status_code == 422
    assert refusal.headers["Content-Type"] == "application/problem+json"
    assert refusal.json()["code"] == case.code
    assert service.http.get(f"/v1/jobs/{job}/results/package").status_code in (404, 422)


def test_unfit_mesh_is_a_result_of_validate(service: Service) -> None:
    job = service.execute("validate", {"meshes": {"href": service.upload(CASES["open"].skin)}})
    ended = service.succeed(job)
    assert ended["verdict"] == "not_ready"
    assert any(finding["severity"] == "error" and finding["places"] for finding in service.report(job)["findings"])
