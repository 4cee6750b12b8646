"""A server whose disk is nearly full takes nothing new, and goes on with everything else."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.errors import LimitError
from store.disk_floor import DiskFloor
from store.settings import Settings
from tests.api.live import problem_of, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer

MORE_THAN_THERE_IS = 2**60


def test_new_work_is_refused_by_name_and_old_work_goes_on(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    given = {
        "data_dir": tmp_path,
        "broker_url": shared_valkey.url,
        "queue": "tests-floor",
        "disk_floor_bytes": MORE_THAN_THERE_IS,
    }
    with serving(Settings(**given)) as live:
        job = live.accepted()
        for refused in (
            live.upload(binary_stl()),
            live.execute("validate", {}),
            live.client.post("/v1/uploads", headers={"Tus-Resumable": "1.0.0", "Upload-Length": "3"}),
            live.client.post(f"/v1/jobs/{job.id}/retry"),
        ):
            assert problem_of(refused, 507, "storage.low")["facts"]["floor_bytes"] == MORE_THAN_THERE_IS
        assert live.client.get(f"/v1/jobs/{job.id}").status_code == 200
        assert "disk" in problem_of(live.client.get("/readyz"), 503, "server.not_ready")["facts"]
        assert live.client.delete(f"/v1/jobs/{job.id}").json()["status"] == "dismissed"


def test_no_floor_is_no_limit(tmp_path: Path) -> None:
    DiskFloor(tmp_path, 0).require()
    DiskFloor(tmp_path, 1).require()
    with pytest.raises(LimitError, match="bytes are free"):
        DiskFloor(tmp_path, MORE_THAN_THERE_IS).require()
