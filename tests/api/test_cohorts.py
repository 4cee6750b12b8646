"""Cohorts over HTTP: accepted whole or not at all, counted, taken back, retried; archives with broken files. No worker runs."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import httpx
import pytest

from core.errors import InputError
from store.job import Job, JobFailure
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving
from tests.core.io.nifti_bytes import nifti, packed, two_boxes
from tests.core.io.stl_bytes import binary_stl

REFUSED = JobFailure.of(InputError("skin.not_closed", "the skin has 3 open edges", edges=3))
BOMB = 3 * 1024**2


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("cohorts"),
        broker_url="redis://127.0.0.1:1/0",
        cohort_subjects=5,
        upload_limit_bytes=4 * 1024**2,
        rate_per_s=0,
    )
    with serving(settings) as made:
        yield made


@pytest.fixture(scope="module")
def hrefs(live: Live) -> list[str]:
    return [str(live.upload(binary_stl(), f"subject {letter}.stl").headers["Location"]) for letter in "abc"]


def sent(live: Live, hrefs: list[str], *, key: str | None = None, **more: Any) -> httpx.Response:
    body = {"process": "validate", "subjects": [{"mesh": {"href": href}} for href in hrefs]} | more
    return live.client.post("/v1/cohorts", json=body, headers={} if key is None else {"Idempotency-Key": key})


def jobs_of(live: Live, cohort: str) -> list[dict[str, Any]]:
    jobs: list[dict[str, Any]] = live.client.get("/v1/jobs", params={"cohort": cohort}).json()["jobs"]
    return jobs[::-1]


def stored(live: Live, job_id: str) -> Job:
    return live.services.jobs.get(DEFAULT_WORKSPACE, job_id)


def end(live: Live, job_id: str, *, well: bool = True) -> None:
    """Play the worker."""
    jobs, attempt = live.services.jobs, stored(live, job_id).attempt
    taken = jobs.claim(job_id, attempt, "tests", 60.0)
    assert taken is not None
    outputs = {
        "report": live.stored(b'{"meshes": {}}', "application/json", "report.json"),
        "package": live.stored(f"zip of {taken.subject}".encode(), "application/zip", "package.zip"),
    }
    if not well:
        jobs.fail(job_id, taken.lease_token, REFUSED)
        return
    assert jobs.finish(job_id, taken.lease_token, verdict="simulation_ready", summary="fine", outputs=outputs, timings_s={})


def zipped(files: Mapping[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", method) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return made.getvalue()


def archived(live: Live, data: bytes, *, key: str | None = None, **settings: Any) -> httpx.Response:
    form = {"cohort": json.dumps({"process": "validate"} | settings)}
    headers = {} if key is None else {"Idempotency-Key": key}
    return live.client.post("/v1/cohort-archives", files={"file": ("all.zip", data)}, data=form, headers=headers)


def test_every_subject_gets_a_job_with_its_mesh_and_inputs(live: Live, hrefs: list[str]) -> None:
    subjects = [
        {"mesh": {"href": hrefs[0]}},
        {"name": "B, <i>again</i>", "mesh": {"href": hrefs[1]}, "inputs": {"min_gap_mm": 2.0}},
        {"name": "two", "inputs": {"meshes": [{"href": hrefs[0]}, {"href": hrefs[2]}]}},
    ]
    response = sent(live, [], subjects=subjects, inputs={"min_gap_mm": 0.5}, name="Pilot", labels=["ages"])
    told = response.json()
    assert (response.status_code, response.headers["Location"]) == (201, f"/v1/cohorts/{told['id']}")
    assert (told["status"], told["subjects"], told["counts"]["accepted"], told["progress"]) == ("running", 3, 3, 0)
    jobs = jobs_of(live, told["id"])
    assert [job["subject"] for job in jobs] == ["subject a", "B, <i>again</i>", "two"]
    assert {(job["cohortID"], job["name"], *job["labels"]) for job in jobs} == {(told["id"], "Pilot", "ages")}
    assert [stored(live, job["jobID"]).inputs["min_gap_mm"] for job in jobs] == [0.5, 2.0, 0.5]
    assert stored(live, jobs[0]["jobID"]).inputs["meshes"] == {"href": hrefs[0]}


def test_a_cohort_ends_with_its_summary_and_a_retry_makes_another(live: Live, hrefs: list[str]) -> None:
    path = sent(live, hrefs).headers["Location"]
    problem_of(live.client.get(f"{path}/results"), 404, "result.not_ready")
    first, second, third = (job["jobID"] for job in jobs_of(live, path.rsplit("/", 1)[1]))
    end(live, first)
    end(live, second, well=False)
    live.client.delete(f"/v1/jobs/{third}")
    told = live.client.get(path).json()
    assert (told["status"], told["progress"], told["ready"]) == ("summarizing", 100, 1)
    assert told["counts"] == {"accepted": 0, "running": 0, "successful": 1, "failed": 1, "dismissed": 1, "refused": 0}
    summary = told["summaryJob"]
    assert live.client.get(f"/v1/jobs/{summary}").json()["processID"] == "cohort_summary"
    problem_of(live.client.get(f"{path}/results"), 404, "result.not_ready")
    end(live, summary)
    assert live.client.get(path).json()["status"] == "finished"
    results = live.client.get(f"{path}/results").json()
    assert set(results) == {"report", "package", "packages"}  # the summary was played
    with zipfile.ZipFile(io.BytesIO(httpx.get(results["packages"]["href"]).content)) as archive:
        assert archive.testzip() is None
        assert {name: archive.read(name) for name in archive.namelist()} == {"subject a/package.zip": b"zip of subject a"}
    reports = live.client.get(f"{path}/results/packages", params={"output": "report"}).content
    assert zipfile.ZipFile(io.BytesIO(reports)).namelist() == ["subject a/report.json"]
    again = live.client.post(f"{path}/retry", headers={"Idempotency-Key": "again"})
    assert (again.status_code, again.json()["round"], again.json()["counts"]["accepted"]) == (202, 2, 2)
    assert live.client.post(f"{path}/retry", headers={"Idempotency-Key": "again"}).headers["Idempotent-Replayed"] == "true"
    for job in (second, third):
        end(live, job)
    assert live.client.get(path).json()["summaryJob"] != summary
    problem_of(live.client.post(f"{path}/retry"), 409, "cohort.nothing_to_retry")


def test_a_cohort_is_dismissed_and_then_removed(live: Live, hrefs: list[str]) -> None:
    path = sent(live, hrefs).headers["Location"]
    assert live.client.delete(path).json()["counts"]["dismissed"] == 3
    assert live.client.delete(path).json()["status"] == "finished", "its summary waited"
    assert live.client.delete(path, params={"keep_ended": True}).json()["status"] == "finished", "it stays"
    assert live.client.delete(path).status_code == 202
    problem_of(live.client.get(path), 404, "cohort.not_found")


def test_one_key_makes_one_cohort(live: Live, hrefs: list[str]) -> None:
    first = sent(live, hrefs, key="once")
    second = sent(live, hrefs, key="once")
    assert (second.json()["id"], second.headers["Idempotent-Replayed"]) == (first.json()["id"], "true")
    problem_of(sent(live, hrefs[:1], key="once"), 422, "idempotency.mismatch")


def test_lists_are_paged(live: Live, hrefs: list[str]) -> None:
    made = [sent(live, hrefs[:1]).json()["id"] for _ in range(3)]
    page = live.client.get("/v1/cohorts", params={"limit": 2}).json()
    following = next(link["href"] for link in page["links"] if link["rel"] == "next")
    told = [one["id"] for one in page["cohorts"]] + [one["id"] for one in httpx.get(following).json()["cohorts"]]
    assert told[:3] == made[::-1]


@pytest.mark.parametrize(
    ("more", "status", "code", "words"),
    [
        ({"subjects": []}, 422, "request.invalid", "subjects"),
        ({"process": "boil"}, 404, "process.not_found", "boil"),
        ({"inputs": {"min_gap_mm": -1}}, 422, "inputs.invalid", "subject number 1"),
        ({"inputs": {"colour": "red"}}, 422, "inputs.unknown_key", "subject number 1"),
        ({"subjectInput": "nose"}, 422, "cohort.no_mesh_input", "nose"),
        ({"surprise": 1}, 422, "request.invalid", "surprise"),
        ({"labels": ["x\n"] * 2 + ["a\nb"]}, 422, "request.invalid", "shown"),
    ],
)
def test_what_is_wrong_for_all_is_refused_by_name(
    live: Live, hrefs: list[str], more: dict[str, Any], status: int, code: str, words: str
) -> None:
    told = problem_of(sent(live, hrefs, **more), status, code)
    assert words in json.dumps(told)


def test_one_bad_subject_refuses_all_and_is_named(live: Live, hrefs: list[str]) -> None:
    before = len(live.client.get("/v1/jobs", params={"limit": 1000}).json()["jobs"])
    gone = "/v1/meshes/00000000-0000-4000-8000-000000000000"
    subjects = [{"mesh": {"href": hrefs[0]}}, {"name": "Ella", "mesh": {"href": gone}}]
    assert "subject Ella" in problem_of(sent(live, [], subjects=subjects), 422, "reference.not_found")["detail"]
    twice = [{"name": "Ella", "mesh": {"href": hrefs[0]}}, {"name": "ELLA", "mesh": {"href": hrefs[1]}}]
    problem_of(sent(live, [], subjects=twice), 422, "cohort.subject_twice")
    told = problem_of(sent(live, [], subjects=[*twice[:1], {"inputs": {"meshes": 3}}]), 422, "inputs.invalid")
    assert told["errors"][0]["pointer"].startswith("/subjects/1/inputs/meshes")
    told = problem_of(sent(live, hrefs * 2), 413, "cohort.too_many_subjects")
    assert told["facts"] == {"subjects": 6, "limit": 5}
    assert len(live.client.get("/v1/jobs", params={"limit": 1000}).json()["jobs"]) == before


def test_an_archive_is_a_cohort_and_its_broken_files_are_told(live: Live) -> None:
    files = {
        "study/Ella.stl": binary_stl(),
        "study/other/Ella.stl": binary_stl(),
        "study/Duke.STL": binary_stl(),
        "study/broken.stl": b"no mesh at all",
        "study/notes.txt": b"do not read",
        "__MACOSX/study/._Ella.stl": b"junk",
        "study/.hidden.stl": b"junk",
    }
    own = [{"name": "Duke", "inputs": {"min_gap_mm": 3.0}}]
    data = zipped(files)  # once: an archive holds the time of day
    response = archived(live, data, key="zip-1", name="Study", inputs={"min_gap_mm": 1.0}, subjects=own)
    told = response.json()
    assert response.status_code == 201, told
    assert (told["subjects"], told["counts"]["accepted"], told["counts"]["refused"]) == (4, 3, 1)
    assert [(one["subject"], one["code"]) for one in told["refused"]] == [("broken", "stl.not_stl")]
    jobs = jobs_of(live, told["id"])
    assert [job["subject"] for job in jobs] == ["Duke", "Ella", "Ella_2"]
    assert [stored(live, job["jobID"]).inputs["min_gap_mm"] for job in jobs] == [3.0, 1.0, 1.0]
    again = archived(live, data, key="zip-1", name="Study", inputs={"min_gap_mm": 1.0}, subjects=own).json()
    assert again["id"] == told["id"]
    assert live.is_clean()


def test_an_archive_for_segment_is_taken_by_its_label_volumes(live: Live) -> None:
    volume = packed(nifti(two_boxes()))
    files = {"a/Ella.nii.gz": volume, "b/Duke.NII": nifti(two_boxes()), "torn.nii.gz": volume[:40], "skin.stl": binary_stl()}
    told = archived(live, zipped(files), process="segment", inputs={"names": {"1": "head"}}).json()
    assert [(one["subject"], one["code"]) for one in told["refused"]] == [("torn", "volume.truncated")]
    assert [job["subject"] for job in jobs_of(live, told["id"])] == ["Ella", "Duke"]
    told = problem_of(archived(live, zipped({"skin.stl": binary_stl()}), process="segment"), 422, "archive.empty")
    assert ".nii.gz" in told["detail"]


def test_an_archive_of_nothing_but_broken_files_has_its_summary_at_once(live: Live) -> None:
    told = archived(live, zipped({"a.stl": b"?", "b.obj": b"?"})).json()
    assert (told["status"], told["counts"]["refused"]) == ("summarizing", 2)
    summary = stored(live, told["summaryJob"])
    assert [one["status"] for one in summary.inputs["subjects"]] == ["refused", "refused"]


def bad_crc() -> bytes:
    data = bytearray(zipped({"a.stl": binary_stl(), "b.stl": binary_stl()}, zipfile.ZIP_STORED))
    data[data.index(b"a.stl") + 40] ^= 1
    return bytes(data)


def test_a_file_with_a_wrong_checksum_spoils_no_other(live: Live) -> None:
    told = archived(live, bad_crc()).json()
    assert [(one["subject"], one["code"]) for one in told["refused"]] == [("a", "archive.corrupt")]
    assert told["counts"]["accepted"] == 1


@pytest.mark.parametrize(
    ("data", "status", "code"),
    [
        (b"PK\x03\x04 torn", 422, "archive.corrupt"),
        (binary_stl(), 422, "archive.corrupt"),
        (zipped({"readme.txt": b"hello"}), 422, "archive.empty"),
        (zipped({f"{number}.stl": binary_stl() for number in range(6)}), 413, "archive.too_many"),
    ],
)
def test_an_archive_that_is_none_is_refused_whole(live: Live, data: bytes, status: int, code: str) -> None:
    problem_of(archived(live, data), status, code)
    assert live.is_clean()


def test_a_bomb_is_refused_and_harms_nobody(live: Live) -> None:
    told = archived(live, zipped({"bomb.stl": bytes(BOMB), "fine.stl": binary_stl()})).json()
    assert [(one["subject"], one["code"]) for one in told["refused"]] == [("bomb", "archive.too_large")]
    assert live.is_clean()


def test_a_refused_cohort_leaves_no_meshes(live: Live) -> None:
    def count() -> int:
        return len(live.client.get("/v1/meshes", params={"limit": 1000}).json()["meshes"])

    before = count()
    data = zipped({"a.stl": binary_stl(), "b.stl": binary_stl()})
    problem_of(archived(live, data, subjects=[{"name": "c", "inputs": {}}]), 422, "cohort.subject_unknown")
    problem_of(archived(live, data, subjects=[{"name": "a", "inputs": {"min_gap_mm": "wide"}}]), 422, "inputs.invalid")
    problem_of(archived(live, data, inputs={"min_gap_mm": "wide"}), 422, "inputs.invalid")
    assert count() == before


def test_a_form_without_settings_or_with_strange_ones_is_refused(live: Live) -> None:
    def form(**fields: str) -> httpx.Response:
        return live.client.post("/v1/cohort-archives", files={"file": ("a.zip", zipped({"a.stl": binary_stl()}))}, data=fields)

    problem_of(form(), 422, "upload.field_missing")
    problem_of(form(cohort="{"), 400, "request.malformed")
    problem_of(form(cohort="[]"), 422, "request.invalid")
    problem_of(form(cohort='{"process": "validate", "x": 1}'), 422, "request.invalid")
    problem_of(form(cohort=" " * 40_000), 422, "upload.field_too_long")
    problem_of(form(cohort="{}", colour="red"), 422, "upload.field_unknown")


def test_quotas_count_every_subject(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, broker_url="redis://127.0.0.1:1/0", quota_jobs=2)
    with serving(settings) as live:
        href = live.mesh_href(binary_stl())
        problem_of(sent(live, [], subjects=[{"name": name, "mesh": {"href": href}} for name in "abc"]), 429, "quota.jobs")
        assert live.client.get("/v1/jobs").json()["jobs"] == []
        assert sent(live, [], subjects=[{"name": name, "mesh": {"href": href}} for name in "ab"]).status_code == 201
