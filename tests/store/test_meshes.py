"""Uploads: rows and bytes, what refers to them, and what the sweep may take, on both databases."""

from __future__ import annotations

from pathlib import Path

import pytest
from sqlalchemy import String

from core.errors import InputError, LimitError, StateError
from store.blobs import Blobs
from store.database import Database
from store.job import JobFailure, JobOutput
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.mesh_inputs import MeshInputs
from store.meshes import CANONICAL_MEDIA_TYPE, Meshes, MeshUpload
from store.record import Record
from store.references import References
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import claimed

FINDING = {"code": "mesh.unit_suspicious", "severity": "warning", "message": "1.8 mm tall", "count": 1, "places": []}


def upload(folder: Path, name: str = "skin") -> MeshUpload:
    """Two small files on their way in; equal names have equal bytes."""
    original, canonical = folder / f"{name}.stl", folder / f"{name}.mesh"
    original.write_bytes(f"solid {name}".encode())
    canonical.write_bytes(f"canonical {name}".encode())
    return MeshUpload(original, canonical, name, f"{name}.stl", "m", "stl", 4, 4, (1.5, 2.0, 1e-3), findings=(FINDING,))


@pytest.fixture
def meshes(db: Database, blobs: Blobs) -> Meshes:
    return Meshes(db, blobs)


@pytest.fixture
def mesh_inputs(db: Database, blobs: Blobs) -> MeshInputs:
    return MeshInputs(db, blobs)


@pytest.fixture
def references(db: Database) -> References:
    return References(db)


def test_an_upload_comes_back_with_its_bytes(meshes: Meshes, blobs: Blobs, tmp_path: Path) -> None:
    sent = upload(tmp_path)
    record = meshes.create(DEFAULT_WORKSPACE, sent)
    assert meshes.get(DEFAULT_WORKSPACE, record.id) == record
    assert (record.name, record.file_name, record.unit, record.format) == ("skin", "skin.stl", "m", "stl")
    assert (record.vertices, record.faces, record.extents_mm, record.findings) == (4, 4, (1.5, 2.0, 1e-3), (FINDING,))
    assert record.size_bytes == len(b"solid skin")
    with blobs.open(record.sha256) as original, blobs.open(record.canonical_sha256) as canonical:
        assert (original.read(), canonical.read()) == (b"solid skin", b"canonical skin")


def test_a_mesh_nobody_sent_is_not_found(meshes: Meshes) -> None:
    for ask in (meshes.get, meshes.delete):
        with pytest.raises(StateError) as caught:
            ask(DEFAULT_WORKSPACE, "00000000-0000-4000-8000-000000000000")
        assert caught.value.code == "mesh.not_found"


def test_pages_of_meshes(meshes: Meshes, tmp_path: Path) -> None:
    made = [meshes.create(DEFAULT_WORKSPACE, upload(tmp_path, f"part{number}")) for number in range(5)]
    first = meshes.list(DEFAULT_WORKSPACE, limit=3)
    second = meshes.list(DEFAULT_WORKSPACE, limit=3, cursor=first.next)
    assert [mesh.name for mesh in (*first.items, *second.items)] == [mesh.name for mesh in reversed(made)]
    assert second.next is None


def test_a_full_disk_leaves_no_row(meshes: Meshes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise LimitError("storage.full", "the disk is full")

    sent = upload(tmp_path)
    monkeypatch.setattr(LocalBlobs, "_place", full)
    with pytest.raises(LimitError):
        meshes.create(DEFAULT_WORKSPACE, sent)
    assert meshes.list(DEFAULT_WORKSPACE).items == ()


def test_a_link_to_an_upload_is_bound_to_its_canonical_bytes(meshes: Meshes, mesh_inputs: MeshInputs, tmp_path: Path) -> None:
    record = meshes.create(DEFAULT_WORKSPACE, upload(tmp_path))
    for href in (f"/v1/meshes/{record.id}", f"http://127.0.0.1:8000/v1/meshes/{record.id}"):
        mesh = mesh_inputs.resolve(DEFAULT_WORKSPACE, href)
        assert (mesh.href, mesh.name, mesh.sha256) == (href, "skin", record.canonical_sha256)
        assert mesh.source_sha256 == record.sha256
        assert mesh.media_type == CANONICAL_MEDIA_TYPE


def finished_with(jobs: Jobs, outputs: dict[str, JobOutput]) -> str:
    job = claimed(jobs)
    jobs.finish(job.id, job.lease_token, verdict="not_ready", summary="", outputs=outputs, timings_s={})
    return job.id


def test_a_link_to_a_result_is_bound_to_its_bytes(jobs: Jobs, blobs: Blobs, mesh_inputs: MeshInputs) -> None:
    blob = blobs.put_bytes(b"solid fat")
    job_id = finished_with(jobs, {"fat": JobOutput(blob.sha256, blob.size, "model/stl", "fat.stl")})
    mesh = mesh_inputs.resolve(DEFAULT_WORKSPACE, f"/v1/jobs/{job_id}/results/fat")
    assert (mesh.name, mesh.sha256, mesh.media_type, mesh.file_name) == ("fat", blob.sha256, "model/stl", "fat.stl")


def test_what_a_failed_job_left_may_be_built_on_and_nothing_else(jobs: Jobs, blobs: Blobs, mesh_inputs: MeshInputs) -> None:
    blob = blobs.put_bytes(b"solid skin")
    job = claimed(jobs)
    left = {"skin": JobOutput(blob.sha256, blob.size, "model/stl", "skin.stl")}
    jobs.fail(job.id, job.lease_token, JobFailure.of(InputError("tissues.cross", "they cross")), outputs=left, timings_s={})
    assert mesh_inputs.resolve(DEFAULT_WORKSPACE, f"/v1/jobs/{job.id}/results/skin").sha256 == blob.sha256
    with pytest.raises(InputError, match="failed, it has no 'fat'") as caught:
        mesh_inputs.resolve(DEFAULT_WORKSPACE, f"/v1/jobs/{job.id}/results/fat")
    assert caught.value.code == "reference.not_ready"


def test_a_package_is_one_and_a_mesh_is_none(jobs: Jobs, blobs: Blobs, mesh_inputs: MeshInputs) -> None:
    blob = blobs.put_bytes(b"PK")
    outputs = {
        "package": JobOutput(blob.sha256, blob.size, "application/zip", "package.zip"),
        "fat": JobOutput(blob.sha256, blob.size, "model/stl", "fat.stl"),
    }
    job = f"/v1/jobs/{finished_with(jobs, outputs)}/results"
    package = mesh_inputs.resolve_package(DEFAULT_WORKSPACE, f"{job}/package")
    assert (package.sha256, package.media_type, package.file_name) == (blob.sha256, "application/zip", "package.zip")
    for resolve, name, code in (
        (mesh_inputs.resolve, "package", "reference.not_a_mesh"),
        (mesh_inputs.resolve_package, "fat", "reference.not_a_package"),
        (mesh_inputs.resolve_package, "skin", "reference.not_found"),
    ):
        with pytest.raises(InputError) as caught:
            resolve(DEFAULT_WORKSPACE, f"{job}/{name}")
        assert caught.value.code == code


def test_every_bad_link_is_refused_by_name(
    jobs: Jobs, blobs: Blobs, meshes: Meshes, mesh_inputs: MeshInputs, tmp_path: Path
) -> None:
    blob = blobs.put_bytes(b"{}")
    done = finished_with(jobs, {"report": JobOutput(blob.sha256, blob.size, "application/json", "report.json")})
    running = claimed(jobs).id
    gone = meshes.create(DEFAULT_WORKSPACE, upload(tmp_path))
    blobs.delete(gone.canonical_sha256)
    nobody = "00000000-0000-4000-8000-000000000000"
    refused = {
        "/v1/meshes/../../etc/passwd": "reference.invalid",
        "/v1/meshes/" + nobody + "\n": "reference.invalid",
        f"/v1/meshes/{nobody}": "reference.not_found",
        f"/v1/jobs/{nobody}/results/fat": "reference.not_found",
        f"/v1/jobs/{done}/results/fat": "reference.not_found",
        f"/v1/jobs/{done}/results/report": "reference.not_a_mesh",
        f"/v1/jobs/{running}/results/fat": "reference.not_ready",
        f"/v1/meshes/{gone.id}": "reference.not_found",
    }
    for href, code in refused.items():
        with pytest.raises(InputError) as caught:
            mesh_inputs.resolve(DEFAULT_WORKSPACE, href)
        assert (href, caught.value.code) == (href, code)


def test_the_sweep_takes_only_what_nothing_refers_to(
    jobs: Jobs, meshes: Meshes, mesh_inputs: MeshInputs, blobs: Blobs, references: References, tmp_path: Path
) -> None:
    first, twin, other = (meshes.create(DEFAULT_WORKSPACE, upload(tmp_path, name)) for name in ("skin", "skin", "other"))
    orphan = blobs.put_bytes(b"nobody's")
    assert first.sha256 == twin.sha256
    assert blobs.sweep(references.all(), older_than_s=3600.0) == []  # too young to judge
    assert blobs.sweep(references.all(), older_than_s=-1.0) == [orphan]

    job = jobs.create(
        DEFAULT_WORKSPACE, "shells", {}, mesh_inputs=[mesh_inputs.resolve(DEFAULT_WORKSPACE, f"/v1/meshes/{other.id}")]
    )
    meshes.delete(DEFAULT_WORKSPACE, first.id)
    meshes.delete(DEFAULT_WORKSPACE, other.id)
    swept = {blob.sha256 for blob in blobs.sweep(references.all(), older_than_s=-1.0)}
    assert swept == {other.sha256}  # its twin keeps the first, the job keeps what it reads
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    meshes.delete(DEFAULT_WORKSPACE, twin.id)
    swept = {blob.sha256 for blob in blobs.sweep(references.all(), older_than_s=-1.0)}
    assert swept == {first.sha256, first.canonical_sha256, other.canonical_sha256}
    assert list(blobs.all()) == []


def test_outputs_shared_by_two_jobs_outlive_one(jobs: Jobs, blobs: Blobs, references: References) -> None:
    blob = blobs.put_bytes(b"package")
    output = {"package": JobOutput(blob.sha256, blob.size, "application/zip", "package.zip")}
    one, other = finished_with(jobs, output), finished_with(jobs, output)
    jobs.dismiss(DEFAULT_WORKSPACE, one)
    assert blobs.sweep(references.all(), older_than_s=-1.0) == []
    jobs.dismiss(DEFAULT_WORKSPACE, other)
    assert blobs.sweep(references.all(), older_than_s=-1.0) == [blob]


def test_every_column_that_names_a_blob_is_looked_at(
    jobs: Jobs, meshes: Meshes, mesh_inputs: MeshInputs, blobs: Blobs, references: References, tmp_path: Path
) -> None:
    columns = {
        f"{table.name}.{column.name}"
        for table in Record.metadata.tables.values()
        for column in table.columns
        if isinstance(column.type, String) and column.type.length == 64 and column.name.endswith("sha256")
    }
    columns.remove("job_inputs.source_sha256")  # says where an input came from; the job does not read it
    assert columns == {
        "meshes.sha256",
        "meshes.canonical_sha256",
        "job_inputs.sha256",
        "job_outputs.sha256",
        "job_checkpoints.sha256",
        "upload_parts.sha256",
    }
    mesh = meshes.create(DEFAULT_WORKSPACE, upload(tmp_path))
    result = blobs.put_bytes(b"result")
    jobs.create(DEFAULT_WORKSPACE, "shells", {}, mesh_inputs=[mesh_inputs.resolve(DEFAULT_WORKSPACE, f"/v1/meshes/{mesh.id}")])
    finished_with(jobs, {"fat": JobOutput(result.sha256, result.size, "model/stl", "fat.stl")})
    assert references.all() == {mesh.sha256, mesh.canonical_sha256, result.sha256}
