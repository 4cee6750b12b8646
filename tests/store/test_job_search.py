"""Names, labels and search: what is found, in which order, page by page, and by which index; on both databases."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import text

from core.errors import StateError
from store.database import Database
from store.job import MeshInput
from store.job_search import JobSearch, jobs_query
from store.job_words import SEARCH_CHARACTERS, JobWords
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.meshes import Meshes
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces
from tests.store.test_meshes import upload

ELSE = "other-lab"


def made(jobs: Jobs, name: str | None = None, *labels: str, mesh: str = "", process: str = "shells", workspace: str = "") -> str:
    meshes = [MeshInput("/v1/meshes/1", mesh, "a" * 64, "model/stl", f"{mesh}.stl")] if mesh else []
    where = WorkspaceId(workspace) if workspace else DEFAULT_WORKSPACE
    return jobs.create(where, process, {}, mesh_inputs=meshes, words=JobWords(name, labels)).id


def found(jobs: Jobs, asked: str = "", *labels: str, **more: Any) -> list[str]:
    """All of it, two to a page."""
    ids: list[str] = []
    cursor: str | None = None
    while True:
        page = jobs.list(DEFAULT_WORKSPACE, JobSearch(labels=labels, text=asked, **more), limit=2, cursor=cursor)
        ids += [job.id for job in page.items]
        cursor = page.next
        if cursor is None:
            return ids


def test_words_are_looked_for_in_name_labels_process_meshes_and_id(jobs: Jobs) -> None:
    first = made(jobs, "Head of Ella", "site=Boston", mesh="VHP-Female")
    second = made(jobs, "Head of Duke", "site=Madrid", mesh="duke_skin", process="ears")
    assert found(jobs, "head") == [second, first]
    assert found(jobs, "ELLA head") == [first]
    assert found(jobs, "female") == [first]
    assert found(jobs, "madrid") == [second]
    assert found(jobs, "ears") == [second]
    assert found(jobs, first[:13]) == [first]
    assert found(jobs, "ella duke") == []
    assert found(jobs, "   ") == [second, first]


@pytest.mark.parametrize("asked", ["100%", "a_b", "a\\b", "Ä", "it's"])
def test_signs_of_a_pattern_are_looked_for_as_they_are(jobs: Jobs, asked: str) -> None:
    meant = made(jobs, f"x {asked} y")
    made(jobs, "x 100 a-b ab a its y")
    assert found(jobs, asked) == [meant]
    assert found(jobs, asked.swapcase()) == [meant]


def test_labels_are_all_asked_for_and_pages_go_on(jobs: Jobs) -> None:
    ids = [
        made(jobs, f"subject-{number}", "pilot", f"site={number % 2}", process=("shells", "ears")[number % 2])
        for number in range(9)
    ]
    made(jobs, "pilot", "pilots")
    assert found(jobs, "", "pilot") == ids[::-1]
    assert found(jobs, "", "pilot", "site=1") == ids[1::2][::-1]
    assert found(jobs, "subject", "site=0", process=("shells",), status=("accepted",)) == ids[::2][::-1]
    assert found(jobs, "subject-7", "pilot") == [ids[7]]
    assert found(jobs, "", "Pilot") == []
    assert found(jobs, "", "pilot", status=("running",)) == []


def test_a_job_can_be_called_otherwise_at_any_time(jobs: Jobs) -> None:
    job = made(jobs, "first", "a", "b", mesh="skin")
    jobs.dismiss(DEFAULT_WORKSPACE, job)
    told = jobs.call(DEFAULT_WORKSPACE, job, lambda words: JobWords("second", (*words.labels[1:], "c")))
    assert (told.name, told.labels, told.status) == ("second", ("b", "c"), "dismissed")
    assert (found(jobs, "first"), found(jobs, "second skin")) == ([], [job])
    assert (found(jobs, "", "a"), found(jobs, "", "c", "b")) == ([], [job])
    jobs.call(DEFAULT_WORKSPACE, job, lambda _words: JobWords())
    assert (found(jobs, "second"), found(jobs, "", "b"), found(jobs, "skin")) == ([], [], [job])
    jobs.dismiss(DEFAULT_WORKSPACE, job)  # removed, labels and all
    assert found(jobs) == []


def test_what_is_foreign_is_not_found(jobs: Jobs, db: Database) -> None:
    Workspaces(db).create(ELSE)
    foreign = made(jobs, "Ella", "pilot", workspace=ELSE)
    assert (found(jobs, "Ella"), found(jobs, "", "pilot")) == ([], [])
    with pytest.raises(StateError) as refused:
        jobs.call(DEFAULT_WORKSPACE, foreign, lambda words: words)
    assert refused.value.code == "job.not_found"


def test_the_longest_words_fit_into_the_index(jobs: Jobs) -> None:
    job = made(jobs, "\U0001f9e0" * 200, *(f"{number:02}" + "\U0001f9b7" * 62 for number in range(20)), mesh="m" * 300)
    assert found(jobs, "\U0001f9e0" * 200) == [job]
    assert len(jobs.list(DEFAULT_WORKSPACE).items[0].labels) == 20
    assert SEARCH_CHARACTERS * 4 + 300 < 2704


@pytest.mark.parametrize(
    ("labels", "index"), [((), "ix_jobs_workspace_created_at_id_search_text"), (("a",), "ix_job_labels_workspace_label")]
)
def test_a_list_walks_an_index_and_sorts_one_page_alone(db: Database, jobs: Jobs, labels: tuple[str, ...], index: str) -> None:
    for _ in range(3):
        made(jobs, "Ella", "a")
    query = jobs_query(DEFAULT_WORKSPACE, JobSearch(labels=labels, text="ella"), None, 51)
    told = str(query.compile(db.engine, compile_kwargs={"literal_binds": True}))
    with db.session() as session:
        if not db.is_sqlite:
            session.execute(text("SET LOCAL enable_seqscan = off"))  # of three rows it would read the table
            session.execute(text("SET LOCAL enable_sort = off"))
            session.execute(text("SET LOCAL enable_bitmapscan = off"))
        plan = session.connection().exec_driver_sql(
            ("EXPLAIN QUERY PLAN " if db.is_sqlite else "EXPLAIN ") + told.replace("%", "%%" if not db.is_sqlite else "%")
        )
        assert index in "\n".join(str(line) for line in plan.all())


def test_meshes_are_searched_by_their_names(db: Database, blobs: LocalBlobs, tmp_path: Path) -> None:
    meshes = Meshes(db, blobs)
    for name in ("Head of Ella", "Torso", "Head of Duke"):
        meshes.create(DEFAULT_WORKSPACE, upload(tmp_path, name))

    def names(asked: str, **more: Any) -> list[str]:
        return [mesh.name for mesh in meshes.list(DEFAULT_WORKSPACE, text=asked, **more).items]

    assert names("HEAD") == ["Head of Duke", "Head of Ella"]
    cursor = meshes.list(DEFAULT_WORKSPACE, text="head", limit=1).next
    assert names("head", limit=1, cursor=cursor) == ["Head of Ella"]
    assert names("ella .stl") == ["Head of Ella"]
    assert names("%") == []
