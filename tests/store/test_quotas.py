"""What a workspace may hold is never exceeded, however many ask at once, on both databases."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy.orm import Session

from core.errors import IntegumentError, LimitError
from store.blobs import Blobs
from store.database import Database
from store.jobs import Jobs
from store.meshes import Meshes, MeshRecord, MeshUpload
from store.quotas import Quotas, Usage
from store.uploads import Uploads
from store.workspace import DEFAULT_WORKSPACE
from store.workspaces import Workspaces
from tests.store.samples import PACKAGE, REFUSED, REPORT, claimed, finish


def limited(db: Database, *, size: int = 0, jobs: int = 0) -> Quotas:
    return Quotas(db, default_bytes=size, default_jobs=jobs)


def refusal(act: Callable[[], object]) -> LimitError:
    with pytest.raises(LimitError) as caught:
        act()
    return caught.value


def upload(folder: Path, size: int) -> MeshUpload:
    path = folder / f"{size}.stl"
    path.write_bytes(b"x" * size)
    return MeshUpload(path, path, "skin", "skin.stl", "mm", "stl", 4, 4, (1.0, 1.0, 1.0))


def test_jobs_that_wait_and_run_count_and_those_that_ended_do_not(db: Database) -> None:
    jobs = Jobs(db, limited(db, jobs=2))
    first = claimed(jobs)
    jobs.create(DEFAULT_WORKSPACE, "shells", {})
    error = refusal(lambda: jobs.create(DEFAULT_WORKSPACE, "shells", {}))
    assert (error.code, error.facts) == ("quota.jobs", {"jobs": 2, "limit": 2})
    failed = jobs.fail(first.id, first.lease_token, REFUSED)
    assert failed is not None
    jobs.create(DEFAULT_WORKSPACE, "shells", {})
    assert refusal(lambda: jobs.retry(DEFAULT_WORKSPACE, first.id)).code == "quota.jobs"
    other = Workspaces(db).create("other").id
    jobs.create(other, "shells", {})  # what one workspace has is nothing to another


def test_of_many_at_once_no_more_are_taken_than_there_is_room_for(db: Database) -> None:
    jobs = Jobs(db, limited(db, jobs=3))
    start = threading.Barrier(8)
    outcomes: list[str] = []

    def send() -> None:
        start.wait(timeout=30)
        try:
            jobs.create(DEFAULT_WORKSPACE, "shells", {})
            outcomes.append("taken")
        except IntegumentError as error:
            outcomes.append(error.code)

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcomes) == ["quota.jobs"] * 5 + ["taken"] * 3


def test_bytes_are_those_of_files_results_and_announced_uploads(db: Database, blobs: Blobs, tmp_path: Path) -> None:
    quotas = limited(db, size=1000)
    meshes, uploads, jobs = Meshes(db, blobs, quotas), Uploads(db, 24.0, quotas), Jobs(db, quotas)
    mesh = meshes.create(DEFAULT_WORKSPACE, upload(tmp_path, 300))
    announced = uploads.create(DEFAULT_WORKSPACE, file_name="a.stl", fields={}, length=400)
    job = claimed(jobs)
    assert finish(jobs, job)
    made = PACKAGE.size + REPORT.size
    assert quotas.usage(DEFAULT_WORKSPACE) == Usage(700 + made, 0)

    too_much = 1000 - 700 - made + 1
    error = refusal(lambda: meshes.create(DEFAULT_WORKSPACE, upload(tmp_path, too_much)))
    assert error.code == "quota.bytes"
    assert error.facts == {"used_bytes": 700 + made, "more_bytes": too_much, "limit_bytes": 1000}
    assert refusal(lambda: uploads.create(DEFAULT_WORKSPACE, file_name="b", fields={}, length=too_much)).code == "quota.bytes"
    assert len(meshes.list(DEFAULT_WORKSPACE).items) == 1

    # the mesh made of an upload takes the place the upload had
    def take_its_place(made_of_it: MeshRecord, session: Session) -> None:
        uploads.finish(DEFAULT_WORKSPACE, announced.id, made_of_it.id, session=session)
        quotas.require_room_for_bytes(DEFAULT_WORKSPACE, 1000 - 700 - made, session)  # at no moment does it count twice

    meshes.create(DEFAULT_WORKSPACE, upload(tmp_path, 400), reserved_bytes=announced.length, also=take_its_place)
    assert quotas.usage(DEFAULT_WORKSPACE).bytes == 700 + made
    meshes.delete(DEFAULT_WORKSPACE, mesh.id)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert quotas.usage(DEFAULT_WORKSPACE) == Usage(400, 0)


def test_who_is_full_may_queue_nothing_more(db: Database, blobs: Blobs, tmp_path: Path) -> None:
    quotas = limited(db, size=300)
    Meshes(db, blobs, quotas).create(DEFAULT_WORKSPACE, upload(tmp_path, 300))
    assert refusal(lambda: Jobs(db, quotas).create(DEFAULT_WORKSPACE, "shells", {})).code == "quota.bytes"
    assert refusal(lambda: quotas.check_room_for_bytes(DEFAULT_WORKSPACE, 0)).code == "quota.bytes"


def test_a_workspace_may_have_limits_of_its_own(db: Database) -> None:
    jobs = Jobs(db, limited(db, jobs=1))
    free, narrow = (Workspaces(db).create(name, quota_jobs=limit).id for name, limit in (("free", 0), ("narrow", 2)))
    for workspace, room in ((DEFAULT_WORKSPACE, 1), (narrow, 2)):
        for _ in range(room):
            jobs.create(workspace, "shells", {})
        assert refusal(lambda workspace=workspace: jobs.create(workspace, "shells", {})).code == "quota.jobs"  # type: ignore[misc]
    for _ in range(5):
        jobs.create(free, "shells", {})
