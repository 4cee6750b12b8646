"""The sum of what is stored, on both databases."""

from __future__ import annotations

from pathlib import Path

from store.database import Database
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.meshes import Meshes, MeshUpload
from store.metrics import Metrics
from store.stored_bytes import MEASURED_AT, SET, STORED_BYTES, StoredBytes
from store.tally import Cell
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import PACKAGE, REPORT, claimed, finish


def test_bytes_are_summed_now_and_then(db: Database, jobs: Jobs, blobs: LocalBlobs, tmp_path: Path) -> None:
    stored, metrics = StoredBytes(db), Metrics(db)
    assert stored.measure()
    assert metrics.read()[Cell(STORED_BYTES, ("uploads",), SET)] == 0
    path = tmp_path / "skin.stl"
    path.write_bytes(b"mesh")
    Meshes(db, blobs).create(DEFAULT_WORKSPACE, MeshUpload(path, path, "skin", "skin.stl", "mm", "stl", 4, 4, (1.0, 1.0, 1.0)))
    finish(jobs, claimed(jobs))
    assert not stored.measure(), "somebody did just now"
    metrics.fold()
    assert stored.measure(fresh_s=0.0)
    cells = metrics.read()
    assert cells[Cell(STORED_BYTES, ("uploads",), SET)] == 4
    assert cells[Cell(STORED_BYTES, ("outputs",), SET)] == PACKAGE.size + REPORT.size
    assert cells[Cell(MEASURED_AT, (), SET)] > 1.7e9
