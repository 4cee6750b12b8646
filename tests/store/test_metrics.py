"""Counting: exact in every snapshot, whoever folds, on both databases."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import func, select

from store.crew_records import TallyRow
from store.database import Database
from store.job import JobOutput, MeshInput
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.meshes import Meshes, MeshUpload
from store.metric_family import FAMILIES, HTTP_REQUESTS, JOB_FAILURES, JOB_WAIT_S, MAX_SERIES, OTHER, STAGE_S, Family
from store.metrics import Metrics
from store.tally import SUM, Cell, Tally, labels_of, labels_text, merge
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import REFUSED, claimed, finish


def told(cells: Mapping[Cell, float], family: str) -> dict[tuple[str, ...], float]:
    """The counters of a family, or how many values a histogram has seen."""
    sums: dict[tuple[str, ...], float] = {}
    for cell, value in cells.items():
        if cell.family == f"integument_{family}" and cell.cell != SUM:
            sums[cell.labels] = sums.get(cell.labels, 0.0) + value
    return sums


def waiting_rows(db: Database) -> int:
    with db.reading() as session:
        return session.execute(select(func.count()).select_from(TallyRow)).scalar_one()


def test_a_job_is_counted_with_the_change_it_makes(db: Database, jobs: Jobs, blobs: LocalBlobs, tmp_path: Path) -> None:
    path = tmp_path / "skin.stl"
    path.write_bytes(b"mesh")
    upload = MeshUpload(path, path, "skin", "skin.stl", "mm", "stl", 5_000, 9_996, (1.0, 1.0, 1.0))
    mesh = Meshes(db, blobs).create(DEFAULT_WORKSPACE, upload)
    read = MeshInput(f"/v1/meshes/{mesh.id}", "skin", mesh.sha256, "model/stl", "skin.stl")
    waiting = jobs.create(DEFAULT_WORKSPACE, "shells", {}, mesh_inputs=[read])
    metrics = Metrics(db)
    assert metrics.read() == {}
    running = jobs.claim(waiting.id, 1, "w", 30.0)
    assert running is not None
    kept = {"report": JobOutput("a" * 64, 3, "application/json", "report.json")}
    timings = {"load": 0.2, "shells: fat": 1.5, "shells: average_body": 40.0}
    jobs.finish(
        *(running.id, running.lease_token),
        verdict="simulation_ready",
        summary="",
        outputs=kept,
        timings_s=timings,
        peak_memory_bytes=2**30,
    )
    refused = claimed(jobs, "validate")
    jobs.fail(refused.id, refused.lease_token, REFUSED)
    jobs.dismiss(DEFAULT_WORKSPACE, jobs.create(DEFAULT_WORKSPACE, "heal", {}).id)
    cells = metrics.read()
    assert told(cells, "job_attempts_total") == {("shells",): 1, ("validate",): 1}
    assert told(cells, "jobs_ended_total") == {("shells", "successful"): 1, ("validate", "failed"): 1, ("heal", "dismissed"): 1}
    assert told(cells, "job_failures_total") == {("validate", "skin.not_closed"): 1}
    assert told(cells, "job_wait_seconds") == {("shells",): 1, ("validate",): 1}
    assert told(cells, "job_run_seconds") == {("shells",): 1, ("validate",): 1}
    assert told(cells, "stage_seconds") == {("shells", "load"): 1, ("shells", "shells"): 1}, "names of surfaces are not labels"
    assert cells[Cell(STAGE_S.name, ("shells", "shells"), SUM)] == 41.5
    assert cells[Cell(STAGE_S.name, ("shells", "shells"), str(STAGE_S.buckets.index(100.0)))] == 1
    assert cells[Cell("integument_job_input_faces", ("shells",), SUM)] == 9_996
    assert cells[Cell("integument_job_peak_memory_bytes", ("shells",), str((27, 28, 29, 30).index(30)))] == 1
    assert waiting_rows(db) == 5
    assert metrics.fold() == 5
    assert waiting_rows(db) == 0
    assert metrics.read() == cells, "where a number lies makes no difference"


def test_what_is_rolled_back_was_never_counted(db: Database, jobs: Jobs) -> None:
    job = claimed(jobs)
    before = Metrics(db).read()
    jobs.release(job.id, job.lease_token)
    assert not finish(jobs, job), "the lease is lost"
    assert told(Metrics(db).read(), "jobs_ended_total") == {}
    assert Metrics(db).read() == before


def test_lost_workers_are_counted(db: Database, jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.expire_all_leases()
    again = jobs.claim(job.id, 2, "w", 30.0)
    assert again is not None
    jobs.expire_all_leases()
    cells = Metrics(db).read()
    assert told(cells, "leases_expired_total") == {("shells",): 2}
    assert told(cells, "job_attempts_total") == {("shells",): 2}
    assert told(cells, "job_failures_total") == {("shells", "worker.lost"): 1}


def test_nothing_is_lost_or_doubled_while_many_count_fold_and_read(db: Database) -> None:
    metrics = Metrics(db)
    rounds, counters = 40, 3

    def count(number: int) -> None:
        for _ in range(rounds):
            tally = Tally()
            tally.count(HTTP_REQUESTS, "GET", f"/{number}", "200")
            tally.observe(JOB_WAIT_S, "shells", value=1.0)
            metrics.add(tally)

    def fold() -> None:
        for _ in range(rounds):
            metrics.fold()

    def read() -> list[float]:
        return [sum(told(metrics.read(), "job_wait_seconds").values()) for _ in range(rounds)]

    with ThreadPoolExecutor() as pool:
        acts = [pool.submit(count, number) for number in range(counters)] + [pool.submit(fold) for _ in range(2)]
        seen = pool.submit(read).result()
        for act in acts:
            act.result()
    assert seen == sorted(seen), "a counter never goes back"
    metrics.fold()
    cells = metrics.read()
    assert told(cells, "http_requests_total") == {("GET", f"/{number}", "200"): rounds for number in range(counters)}
    assert cells[Cell(JOB_WAIT_S.name, ("shells",), SUM)] == rounds * counters


def test_names_a_child_made_up_do_not_become_series_without_end() -> None:
    totals: dict[Cell, float] = {}
    for number in range(MAX_SERIES + 50):
        tally = Tally()
        tally.count(JOB_FAILURES, "shells", f"made.up_{number}")
        for cell in merge(totals, [(Cell(JOB_FAILURES.name, ("shells", f"made.up_{number}")), 1.0)]):
            totals[cell] = totals.get(cell, 0.0) + 1.0
    assert len(totals) == MAX_SERIES + 1
    assert totals[Cell(JOB_FAILURES.name, (OTHER, OTHER))] == 50
    assert len(Tally().describe()) == 0


def test_labels_of_any_text_can_be_kept(db: Database) -> None:
    tally = Tally()
    tally.count(JOB_FAILURES, "shells\x00", "\ud800" + "x" * 5_000)
    Metrics(db).add(tally)
    Metrics(db).fold()
    ((_, code),) = told(Metrics(db).read(), "job_failures_total")
    assert len(code) == 80
    assert labels_of(labels_text(("ä", '"', "\n"))) == ("ä", '"', "\n")


@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES)
def test_families_follow_the_conventions(family: Family) -> None:
    assert family.name.startswith("integument_")
    assert list(family.buckets) == sorted(set(family.buckets))
    assert family.name.endswith("_total") != bool(family.buckets)
    assert len(family.name) <= 64
