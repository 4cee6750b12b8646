"""A study of seven bodies as one zip: one file is no mesh, one surface is open, one is a giant. And what a retry mends."""

from __future__ import annotations

import csv
import io
import json
import time
import zipfile
from typing import Any

from core.mesh import Mesh
from tests.acceptance.service import LIMIT_S, LOOK_S, Service, binary_stl
from tests.solids import sphere

RADII_MM = {"anna": 10.0, "bert": 10.2, "carl": 9.9, "dora": 10.1, "emma": 9.8, "giant": 80.0}


def finished(service: Service, path: str) -> dict[str, Any]:
    deadline = time.monotonic() + LIMIT_S
    while (told := service.http.get(path).json())["status"] != "finished":
        assert time.monotonic() < deadline, told
        time.sleep(LOOK_S)
    found: dict[str, Any] = told
    return found


def zipped() -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, radius in RADII_MM.items():
            archive.writestr(f"study/{name}.stl", binary_stl(sphere(radius, 1)))
        ball = sphere(10.0, 1)
        archive.writestr("study/open.stl", binary_stl(Mesh.of(ball.vertices, ball.faces[1:])))
        archive.writestr("study/torn.stl", b"solid torn\nfacet normal 0 0")
    return made.getvalue()


def test_a_study_runs_as_easily_as_one_subject(service: Service) -> None:
    settings = {"process": "validate", "name": "Study", "labels": ["pilot"]}
    reply = service.http.post(
        "/v1/cohort-archives", files={"file": ("study.zip", zipped())}, data={"cohort": json.dumps(settings)}
    )
    assert reply.status_code == 201, reply.text
    told = finished(service, reply.headers["Location"])
    assert told["counts"] == {"accepted": 0, "running": 0, "successful": 7, "failed": 0, "dismissed": 0, "refused": 1}
    assert (told["subjects"], told["ready"], told["refused"][0]["subject"]) == (8, 6, "torn")
    results = service.http.get(f"{reply.headers['Location']}/results").json()
    table = service.http.get(results["table"]["href"])
    assert table.headers["content-type"].startswith("text/csv")
    rows = {row["subject"]: row for row in csv.DictReader(io.StringIO(table.text))}
    assert list(rows) == [*sorted([*RADII_MM, "open"]), "torn"]
    assert {name for name, row in rows.items() if row["verdict"] == "simulation_ready"} == set(RADII_MM)
    assert (rows["open"]["verdict"], rows["torn"]["status"]) == ("not_ready", "refused")
    summary = service.http.get(results["summary"]["href"]).json()
    assert {(one["subject"], one["column"]) for one in summary["outliers"]} >= {
        ("giant", "mesh.volume_mm3"),
        ("giant", "mesh.area_mm2"),
        ("open", "errors"),
    }
    assert {one["subject"] for one in summary["outliers"]} == {"giant", "open"}
    page = service.http.get(results["report_html"]["href"]).text
    assert "6 of 8 subjects are simulation ready, 1 not ready, 1 refused" in page
    with zipfile.ZipFile(io.BytesIO(service.http.get(results["packages"]["href"]).content)) as archive:
        assert archive.testzip() is None
        assert sorted(archive.namelist()) == [f"{name}/report.json" for name in sorted([*RADII_MM, "open"])]


def test_failed_subjects_are_kept_apart_and_retried(service: Service) -> None:
    ball = sphere(10.0, 1)
    whole, torn = service.upload(ball, "whole"), service.upload(Mesh.of(ball.vertices, ball.faces[1:]), "torn")
    body = {
        "process": "heal",
        "inputs": {"fill_holes": False},
        "subjects": [{"mesh": {"href": whole}}, {"name": "torn", "mesh": {"href": torn}}],
    }
    path = service.http.post("/v1/cohorts", json=body).headers["Location"]
    told = finished(service, path)
    assert (told["counts"]["successful"], told["counts"]["failed"], told["ready"]) == (1, 1, 1)
    first = told["summaryJob"]
    assert service.status(first)["verdict"] == "not_ready"
    failed = next(one for one in json.loads(service.result(first, "summary"))["rows"] if one["status"] == "failed")
    assert failed["subject"] == "torn"
    assert failed["code"]
    assert service.http.post(f"{path}/retry").status_code == 202
    again = finished(service, path)
    assert (again["round"], again["counts"]["failed"]) == (2, 1)
    assert service.http.get(f"/v1/jobs/{first}").status_code == 404
    assert service.result(again["summaryJob"], "table")
