"""Results and reports."""

from __future__ import annotations

import base64
import hashlib
import json
from pathlib import Path

import httpx
import meshio
import numpy as np
import pytest

from api.downloads import content_disposition, requested_span
from api.mesh_export import WRITTEN_AS
from api.routes.meshes import FILE_MEDIA_TYPES
from api.schemas.job_report import JobReport
from core.errors import InputError, InternalError, LimitError, StateError
from core.fields.mapped import MappedField
from core.io.registry import FORMATS, WRITERS, WRITTEN_ONLY, write_mesh
from core.package.field_files import write_msh
from core.package.tissue import FREE_SPACE, Tissue
from core.schema.finding import Finding, Place, Severity
from store.job import JobFailure
from store.workspace import DEFAULT_WORKSPACE
from tests.acceptance.service import binary_stl
from tests.api.live import REPORT, REPORT_HTML, Live, problem_of
from tests.solids import sphere

PACKAGE = bytes(range(256)) * 4096  # 1 MiB: several chunks
OUTPUTS = {
    "package": (PACKAGE, "application/zip", "package.zip"),
    "fat": (b"solid", "model/stl", "fat.stl"),
    "report": (REPORT, "application/json", "report.json"),
}


@pytest.fixture(scope="module")
def package(api: Live) -> str:
    """Path of a file to download."""
    return f"/v1/jobs/{api.successful(OUTPUTS).id}/results/package"


def test_results_are_a_document_of_references(api: Live) -> None:
    job = api.successful(OUTPUTS)
    document = api.client.get(f"/v1/jobs/{job.id}/results").json()
    assert document == {
        name: {"href": f"{api.url}/v1/jobs/{job.id}/results/{name}", "type": media_type, "title": file_name}
        for name, (_, media_type, file_name) in OUTPUTS.items()
    }
    for name, (data, media_type, _) in OUTPUTS.items():
        response = httpx.get(document[name]["href"])
        assert response.content == data
        assert response.headers["content-type"].partition(";")[0] == media_type


def test_a_download_says_what_it_is(api: Live, package: str) -> None:
    response = api.client.get(package)
    digest = hashlib.sha256(PACKAGE)
    assert response.status_code == 200
    assert response.headers["etag"] == f'"{digest.hexdigest()}"'
    assert response.headers["repr-digest"] == f"sha-256=:{base64.b64encode(digest.digest()).decode()}:"
    assert response.headers["content-length"] == str(len(PACKAGE))
    assert response.headers["content-disposition"] == 'attachment; filename="package.zip"'
    assert response.headers["accept-ranges"] == "bytes"
    assert response.headers["x-content-type-options"] == "nosniff"


def test_head_says_the_same_without_the_bytes(api: Live, package: str) -> None:
    whole, head = api.client.get(package), api.client.head(package)
    ours = ("etag", "repr-digest", "content-length", "content-type", "content-disposition", "accept-ranges", "cache-control")
    assert {name: head.headers[name] for name in ours} == {name: whole.headers[name] for name in ours}
    assert (head.status_code, head.content) == (200, b"")
    part = api.client.head(package, headers={"Range": "bytes=0-9"})
    assert (part.status_code, part.headers["content-length"]) == (206, "10")


@pytest.mark.parametrize(
    ("asked", "first", "last"),
    [
        ("bytes=0-0", 0, 0),
        ("bytes=10-300000", 10, 300_000),
        ("bytes=1048570-", 1_048_570, 1_048_575),
        ("bytes=1048570-9999999999", 1_048_570, 1_048_575),
        ("bytes=-6", 1_048_570, 1_048_575),
        ("bytes=-9999999999", 0, 1_048_575),
        ("BYTES = 5 - 9".replace(" ", ""), 5, 9),
    ],
)
def test_ranges_give_exactly_those_bytes(api: Live, package: str, asked: str, first: int, last: int) -> None:
    response = api.client.get(package, headers={"Range": asked})
    assert response.status_code == 206
    assert response.headers["content-range"] == f"bytes {first}-{last}/{len(PACKAGE)}"
    assert response.content == PACKAGE[first : last + 1]


@pytest.mark.parametrize(
    "asked", ["bytes=5-4", "bytes=-", "bytes=a-b", "lines=1-2", "bytes=0-1,5-6", "bytes=" + "9" * 19 + "-", "x"]
)
def test_ranges_nobody_understands_get_the_whole(api: Live, package: str, asked: str) -> None:
    response = api.client.get(package, headers={"Range": asked})
    assert (response.status_code, response.content) == (200, PACKAGE)


@pytest.mark.parametrize("asked", ["bytes=1048576-", "bytes=99999999-100000000", "bytes=-0"])
def test_ranges_behind_the_end_are_refused_with_the_size(api: Live, package: str, asked: str) -> None:
    response = api.client.get(package, headers={"Range": asked})
    problem = problem_of(response, 416, "range.not_satisfiable")
    assert response.headers["content-range"] == f"bytes */{len(PACKAGE)}"
    assert problem["facts"] == {"size": len(PACKAGE)}


def test_an_interrupted_download_goes_on_only_with_the_same_bytes(api: Live, package: str) -> None:
    etag = api.client.head(package).headers["etag"]
    same = api.client.get(package, headers={"Range": "bytes=100-", "If-Range": etag})
    assert (same.status_code, same.content) == (206, PACKAGE[100:])
    for other in ('"0000"', f"W/{etag}", "Sat, 21 Nov 2026 00:00:00 GMT"):
        whole = api.client.get(package, headers={"Range": "bytes=100-", "If-Range": other})
        assert (whole.status_code, whole.content) == (200, PACKAGE)


def test_what_the_client_has_is_not_sent_again(api: Live, package: str) -> None:
    etag = api.client.head(package).headers["etag"]
    for known in (etag, f'"other", {etag}', f"W/{etag}", "*"):
        response = api.client.get(package, headers={"If-None-Match": known, "Range": "bytes=0-9"})
        assert (response.status_code, response.content) == (304, b"")
        assert response.headers["etag"] == etag
    assert api.client.get(package, headers={"If-None-Match": '"other"'}).status_code == 200


def test_an_empty_file_has_no_ranges() -> None:
    assert requested_span(None, 0) is None
    for asked in ("bytes=0-", "bytes=-1"):
        with pytest.raises(StateError, match="the 0 bytes"):
            requested_span(asked, 0)


@pytest.mark.parametrize(
    ("file_name", "header"),
    [
        ("skin.stl", 'attachment; filename="skin.stl"'),
        ("Körper 1.stl", "attachment; filename=\"K_rper_1.stl\"; filename*=UTF-8''K%C3%B6rper%201.stl"),
        (
            'a"b\r\nSet-Cookie: x.stl',
            "attachment; filename=\"a_b_Set-Cookie_x.stl\"; filename*=UTF-8''a%22b_Set-Cookie%3A%20x.stl",
        ),
        ("../../etc/passwd", "attachment; filename=\"etc_passwd\"; filename*=UTF-8''_.._etc_passwd"),
        ("\ud800", "attachment; filename=\"file\"; filename*=UTF-8''_"),
        ("", 'attachment; filename="file"'),
    ],
)
def test_file_names_cannot_break_out_of_the_header(file_name: str, header: str) -> None:
    assert content_disposition(file_name) == header
    assert content_disposition(file_name, inline=True) == header.replace("attachment", "inline")


def test_results_of_a_job_under_way_are_not_ready(api: Live) -> None:
    for job in (api.accepted(), api.running()):
        for path in ("/results", "/results/package"):
            problem = problem_of(api.client.get(f"/v1/jobs/{job.id}{path}"), 404, "result.not_ready")
            assert problem["type"] == "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/result-not-ready"
            assert problem["retryable"]
        problem_of(api.client.get(f"/v1/jobs/{job.id}/report"), 404, "job.no_report")


HOLE = Finding(
    code="mesh.open_edge",
    severity=Severity.ERROR,
    message="3 open edges",
    count=3,
    places=(Place(mesh="skin", point_mm=(1.0, 2.0, 3.0), faces=(7, 8)),),
)


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (InputError("skin.not_closed", "the skin has 3 open edges", findings=(HOLE,), edges=3), 422),
        (LimitError("limit.memory", "more than 8 GiB", limit_bytes=8), 413),
        (InternalError("child.crashed", "ended by SIGSEGV", signal="SIGSEGV"), 500),
    ],
)
def test_results_of_a_failed_job_are_its_failure(api: Live, error: InputError, status: int) -> None:
    job = api.failed(JobFailure.of(error))
    for path in ("/results", "/results/package"):
        problem = problem_of(api.client.get(f"/v1/jobs/{job.id}{path}"), status, error.code)
        assert problem["detail"] == error.message
        assert problem["facts"] == error.facts
        assert problem["findings"] == [finding.model_dump(mode="json") for finding in error.findings]


def test_a_failed_job_still_has_its_report(api: Live) -> None:
    job = api.failed(JobFailure.of(InputError("skin.not_closed", "the skin has 3 open edges", edges=3)))
    assert api.client.get(f"/v1/jobs/{job.id}/results/report").content == REPORT
    told = api.client.get(f"/v1/jobs/{job.id}/report").json()
    assert told["job"]["failure"]["code"] == "skin.not_closed"
    assert told["timings_s"] == {"shells": 1.5}
    bare = api.failed(JobFailure.of(InternalError("worker.lost", "2 workers died")), report=False)
    problem_of(api.client.get(f"/v1/jobs/{bare.id}/report"), 404, "job.no_report")


def test_the_results_of_a_failed_job_tell_what_it_left(api: Live) -> None:
    left = {"skin": (binary_stl(sphere(10.0, 1)), "model/stl", "skin.stl"), "steps": (b"{}", "application/json", "steps.json")}
    failure = JobFailure.of(InputError("tissues.cross", "1 pair of tissues crosses", pairs=1))
    job = api.failed(failure, left=left)
    links = api.client.get(f"/v1/jobs/{job.id}").json()["links"]
    (results,) = (link["href"] for link in links if link["rel"].endswith("/results"))
    problem = problem_of(httpx.get(results), 422, "tissues.cross")
    outputs = {name: (output["type"], output["title"]) for name, output in problem["outputs"].items()}
    assert outputs == {**{name: told[1:] for name, told in left.items()}, "report": ("application/json", "report.json")}
    items = {link["href"]: (link["type"], link["title"]) for link in links if link["rel"] == "item"}
    assert items == {output["href"]: (output["type"], output["title"]) for output in problem["outputs"].values()}
    assert httpx.get(problem["outputs"]["skin"]["href"]).content == left["skin"][0]
    assert api.execute("validate", {"meshes": {"href": problem["outputs"]["skin"]["href"]}}).status_code == 201
    refused = api.execute("validate", {"meshes": {"href": f"/v1/jobs/{job.id}/results/fat"}})
    assert "failed" in problem_of(refused, 422, "reference.not_ready")["detail"]
    bare = api.failed(failure, report=False)
    assert problem_of(api.client.get(f"/v1/jobs/{bare.id}/results"), 422, "tissues.cross")["outputs"] == {}


def test_an_unknown_output_is_named_with_those_there_are(api: Live) -> None:
    job = api.successful(OUTPUTS)
    for name in ("bone", "%2e%2e", "%00", "x" * 500):
        problem = problem_of(api.client.get(f"/v1/jobs/{job.id}/results/{name}"), 404, "output.not_found")
        assert "package, fat, report" in problem["detail"]


def test_the_report_adds_what_belongs_to_the_run(api: Live) -> None:
    job = api.successful()
    response = api.client.get(f"/v1/jobs/{job.id}/report")
    assert JobReport.model_validate_json(response.text).job.id == job.id
    told = response.json()
    about = told.pop("job")
    assert told.pop("timings_s") == {"validate": 0.25}
    assert told == json.loads(REPORT)
    assert about["id"] == job.id
    assert (about["process"], about["status"], about["attempt"]) == ("validate", "successful", 1)
    assert about["created"] <= about["started"] <= about["finished"]
    assert about["peak_memory_bytes"] == 123_456_789
    assert api.client.get(f"/v1/jobs/{job.id}/results/report").content == REPORT, "the file itself stays what the job made"


@pytest.mark.parametrize(
    ("accept", "html"),
    [
        ("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8", True),
        ("text/html", True),
        ("application/json;q=0.5, text/html;q=0.6", True),
        ("text/*", True),
        ("*/*", False),
        ("", False),
        ("application/json", False),
        ("text/html;q=0.5, application/json", False),
        ("text/html;q=0, */*", False),
        ("text/html;q=oops", False),
    ],
)
def test_people_and_programs_get_the_report_they_can_read(api: Live, accept: str, html: bool) -> None:
    response = api.client.get(f"/v1/jobs/{api.successful().id}/report", headers={"Accept": accept})
    assert response.headers["vary"] == "Accept"
    assert (response.content == REPORT_HTML) == html
    assert response.headers["content-type"].startswith("text/html" if html else "application/json")


def test_the_report_for_people_shows_itself_but_may_ask_nothing(api: Live) -> None:
    response = api.client.get(f"/v1/jobs/{api.successful().id}/report", headers={"Accept": "text/html"})
    assert response.headers["content-disposition"].startswith("inline")
    policy = response.headers["content-security-policy"]
    assert policy.startswith("default-src 'none'; img-src data:; style-src 'unsafe-inline';")
    # its script runs, but in an origin of its own: without storage, cookies or this server's answers
    assert policy.endswith("; sandbox allow-scripts allow-downloads")
    assert "connect-src" not in policy
    assert "same-origin" not in policy
    html = f"/v1/jobs/{api.successful().id}/results/report_html"
    assert api.client.get(html).headers["content-disposition"].startswith("attachment")


@pytest.mark.parametrize("file_format", ["original", "stl", "stl-ascii", "mat", "ply", "obj"])
def test_meshes_come_in_every_format(api: Live, mesh_href: str, stl: bytes, file_format: str) -> None:
    response = api.client.get(f"{mesh_href}/file", params={"format": file_format})
    assert response.status_code == 200
    assert response.headers["etag"] == f'"{hashlib.sha256(response.content).hexdigest()}"'
    assert api.is_clean()
    again = api.client.get(f"{mesh_href}/file", params={"format": file_format})
    assert again.content == response.content
    assert response.headers["content-type"] in FILE_MEDIA_TYPES
    extension = {"original": "stl", "stl-ascii": "stl"}.get(file_format, file_format)
    assert response.headers["content-disposition"] == f'attachment; filename="skin.{extension}"'
    if file_format == "original":
        assert response.content == stl
    told = api.upload(response.content, f"again.{extension}").json()
    assert (told["vertices"], told["faces"], told["extents_mm"]) == (4, 4, [100.0, 100.0, 100.0])


@pytest.mark.parametrize(("file_format", "first"), [("glb", b"glTF"), ("vtu", b"<?xml")])
def test_meshes_come_in_formats_for_viewers(api: Live, mesh_href: str, file_format: str, first: bytes) -> None:
    response = api.client.get(f"{mesh_href}/file", params={"format": file_format})
    assert response.content.startswith(first)
    assert response.headers["content-type"] in FILE_MEDIA_TYPES
    assert response.headers["content-disposition"] == f'attachment; filename="skin.{file_format}"'


def test_a_large_mesh_is_thinned_for_the_eye_alone(api: Live, tmp_path: Path) -> None:
    ball = sphere(50.0, 4)
    write_mesh(ball, tmp_path / "ball.ply", "ply", "ball")
    href = api.upload((tmp_path / "ball.ply").read_bytes(), "ball.ply").headers["location"]
    coarse = api.client.get(f"{href}/file", params={"format": "stl", "most_faces": 1000})
    told = api.upload(coarse.content, "coarse.stl").json()
    assert 200 < told["faces"] <= 1000
    assert all(90.0 < extent <= 100.0 for extent in told["extents_mm"])
    whole = api.client.get(f"{href}/file", params={"format": "stl", "most_faces": len(ball.faces)})
    assert whole.content == api.client.get(f"{href}/file", params={"format": "stl"}).content
    assert api.client.get(f"{href}/file", params={"most_faces": 1000}).content == (tmp_path / "ball.ply").read_bytes()
    assert (
        problem_of(api.client.get(f"{href}/file?most_faces=10"), 422, "request.invalid")["errors"][0]["pointer"] == "most_faces"
    )
    assert api.is_clean()


def test_a_large_surface_of_a_job_is_thinned_and_kept(api: Live) -> None:
    ball = sphere(50.0, 4)
    job = api.successful({"skin": (binary_stl(ball), "model/stl", "skin.stl")})
    path = f"/v1/jobs/{job.id}/results/skin"
    whole = api.client.get(path)
    assert api.client.get(path, params={"most_faces": len(ball.faces)}).content == whole.content
    coarse = api.client.get(path, params={"most_faces": 1000})
    assert coarse.headers["integument-faces"] == str(len(ball.faces))
    assert coarse.headers["content-type"] == "model/stl"
    assert 200 < api.upload(coarse.content, "coarse.stl").json()["faces"] <= 1000
    kept = [each for each in (api.services.settings.data_dir / "previews").iterdir() if each.read_bytes() == coarse.content]
    assert len(kept) == 1
    kept[0].write_bytes(b"kept")  # what is kept is not made again
    assert api.client.get(path, params={"most_faces": 1000}).content == b"kept"
    kept[0].unlink()
    assert api.client.get(path, params={"most_faces": 1000}).content == coarse.content
    assert problem_of(api.client.get(path, params={"most_faces": 10}), 422, "request.invalid")
    assert api.is_clean()


def test_formats_are_told_as_they_are_written() -> None:
    known = {name: FORMATS[name.partition("-")[0]] for name in WRITERS}
    read_too = {name: (each.media_type, each.extensions[0]) for name, each in known.items()}
    assert {name: WRITTEN_AS[name] for name in WRITERS} == read_too
    assert set(WRITTEN_AS) == {*WRITERS, *WRITTEN_ONLY}


def test_a_converted_mesh_can_be_fetched_in_parts(api: Live, mesh_href: str) -> None:
    path = f"{mesh_href}/file?format=obj"
    whole = api.client.get(path)
    part = api.client.get(path, headers={"Range": "bytes=10-19", "If-Range": whole.headers["etag"]})
    assert (part.status_code, part.content) == (206, whole.content[10:20])
    assert api.client.head(path).headers["content-length"] == str(len(whole.content))
    assert api.client.get(path, headers={"If-None-Match": whole.headers["etag"]}).status_code == 304
    assert api.is_clean()


def test_unknown_formats_and_meshes_are_refused(api: Live, mesh_href: str) -> None:
    problem = problem_of(api.client.get(f"{mesh_href}/file?format=fbx"), 422, "request.invalid")
    assert problem["errors"][0]["pointer"] == "format"
    problem_of(api.client.get("/v1/meshes/1"), 404, "mesh.not_found")
    problem_of(api.client.get("/v1/meshes/00000000-0000-4000-8000-000000000000/file"), 404, "mesh.not_found")
    problem_of(api.client.delete("/v1/meshes/00000000-0000-4000-8000-000000000000"), 404, "mesh.not_found")


def test_a_deleted_mesh_is_gone_but_jobs_keep_its_bytes(api: Live, stl: bytes) -> None:
    href = api.mesh_href(stl)
    job = api.execute("validate", {"meshes": {"href": href}}).json()["jobID"]
    assert api.client.delete(href).status_code == 204
    problem_of(api.client.get(href), 404, "mesh.not_found")
    problem_of(api.execute("validate", {"meshes": {"href": href}}), 422, "reference.not_found")
    assert api.services.blobs.path(api.services.jobs.get(DEFAULT_WORKSPACE, job).mesh_inputs[href].sha256).exists()


def test_mesh_lists_are_paged(api: Live, stl: bytes) -> None:
    hrefs = [api.mesh_href(stl) for _ in range(3)]
    first = api.client.get("/v1/meshes?limit=2").json()
    (link,) = (link["href"] for link in first["links"] if link["rel"] == "next")
    second = httpx.get(link).json()
    ids = [mesh["id"] for mesh in (*first["meshes"], *second["meshes"])]
    assert [f"/v1/meshes/{mesh_id}" for mesh_id in ids[:3]] == hrefs[::-1]


def test_a_lost_blob_is_our_fault(api: Live) -> None:
    job = api.successful({"report": (b'{"lost": 1}', "application/json", "report.json")})
    Path(api.services.blobs.path(job.outputs["report"].sha256)).unlink()
    for path in ("/report", "/results/report"):
        problem_of(api.client.get(f"/v1/jobs/{job.id}{path}"), 500, "blob.missing")


def test_a_large_field_is_thinned_with_its_values(api: Live, tmp_path: Path) -> None:
    ball = sphere(50.0, 4)
    count = len(ball.faces)
    values = MappedField(np.arange(1.0, count + 1.0)[:, None], np.zeros(count), "nearest")
    write_msh(tmp_path / "fields.msh", [Tissue("skin", ball, None, 1.0, FREE_SPACE)], {"skin": values})
    content = ((tmp_path / "fields.msh").read_bytes(), "application/x-gmsh", "fields.msh")
    job = api.successful({"msh": content}, process="fields")
    path = f"/v1/jobs/{job.id}/results/msh"
    assert api.client.get(path).content == content[0]
    coarse = api.client.get(path, params={"most_faces": 1000})
    assert coarse.headers["content-type"] == "application/x-gmsh"
    assert coarse.headers["content-disposition"] == 'attachment; filename="fields.msh"'
    (tmp_path / "coarse.msh").write_bytes(coarse.content)
    seen = meshio.read(tmp_path / "coarse.msh", file_format="gmsh")
    assert 200 < len(seen.cells[0].data) <= 1000
    assert set(seen.cell_data["magnE"][0]) <= set(values.magnitude)
    other = api.successful({"msh": content}, process="tetrahedralize")
    assert api.client.get(f"/v1/jobs/{other.id}/results/msh", params={"most_faces": 1000}).content == content[0]
    assert api.is_clean()
