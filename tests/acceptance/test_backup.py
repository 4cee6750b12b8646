"""A service backed up while it works, its data destroyed, and brought back: every download is the same, byte by byte."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import psycopg
import pytest
from sqlalchemy import make_url

from store.s3_place import S3Place
from tests.acceptance.lab import lab
from tests.acceptance.service import Service
from tests.embedded import embedded
from tests.postgres import PostgresServer
from tests.seaweed import SeaweedServer
from tests.solids import cube, sphere
from tests.valkey import ValkeyServer

ONE_AT_A_TIME = {"INTEGUMENT_WORKER_CONCURRENCY": "1"}


def admin(*words: str, **variables: str) -> Any:
    """As an operator calls it; what it answered."""
    command = [sys.executable, "-m", "server.admin", "--json", *words]
    done = subprocess.run(command, env={**os.environ, **variables}, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def downloads(service: Service, under_way: tuple[str, ...]) -> dict[str, bytes]:
    """Everything users can fetch of meshes and of jobs that have ended, and what is said of them; those `under_way` may end."""
    found = {}
    for mesh in service.http.get("/v1/meshes").json()["meshes"]:
        found[f"mesh {mesh['id']}"] = json.dumps({key: value for key, value in mesh.items() if key != "links"}).encode()
        found[f"mesh {mesh['id']} file"] = service.http.get(f"/v1/meshes/{mesh['id']}/file").content
    for job in service.http.get("/v1/jobs", params={"status": "successful,failed"}).json()["jobs"]:
        if job["jobID"] in under_way:
            continue
        found[f"job {job['jobID']}"] = json.dumps({key: value for key, value in job.items() if key != "links"}).encode()
        found[f"job {job['jobID']} events"] = service.http.get(f"/v1/jobs/{job['jobID']}/events").content
        for output in service.http.get(f"/v1/jobs/{job['jobID']}/results").json():
            found[f"job {job['jobID']} {output}"] = service.result(job["jobID"], output)
    return found


def work(service: Service) -> tuple[str, str]:
    """One job that ends well, one that is at work, one that waits; the last two."""
    box, ball = service.upload(cube(100.0), "box"), service.upload(sphere(60.0, 4), "ball")
    service.succeed(service.execute("validate", {"meshes": {"href": box}}))
    running = service.shells(ball)
    waiting = service.execute("validate", {"meshes": {"href": ball}})
    service.wait(running, lambda status: status["status"] == "running")
    return running, waiting


def same(after: dict[str, bytes], before: dict[str, bytes]) -> Iterator[str]:
    """The names of what differs."""
    return (name for name in before.keys() | after.keys() if before.get(name) != after.get(name))


@pytest.mark.timeout(600)
def test_an_embedded_server_comes_back_after_its_folder_was_destroyed(tmp_path: Path) -> None:
    data, vault = tmp_path / "data", str(tmp_path / "vault")
    with embedded(data, ONE_AT_A_TIME) as server:
        with closing(Service(server.url)) as first:
            jobs = work(first)
            server.part("worker").suspend()  # so that the job is at work as long as the backup takes
            before = downloads(first, jobs)
            made = admin("--data-dir", str(data), "backup", vault)
            assert made["missing"] == made["corrupt"] == 0
        server.kill()
        shutil.rmtree(data)

        restored = admin("--data-dir", str(data), "restore", vault, "--yes")
        assert restored["jobs_queued_again"] == 1
        server.start()
        with closing(Service(server.url)) as second:
            assert list(same(downloads(second, jobs), before)) == []
            assert len(before) >= 8
            for job in jobs:
                assert second.succeed(job)["attempt"] == 1
    assert [line["whole"] for line in admin("--data-dir", str(data), "backups", vault, "--verify")] == [True]


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_a_lab_comes_back_after_database_and_bucket_were_destroyed(
    tmp_path: Path, postgres: PostgresServer, valkey: ValkeyServer, seaweed: SeaweedServer
) -> None:
    database_url, blobs_url = postgres.new_database(), seaweed.new_bucket()
    variables = {
        "INTEGUMENT_DATABASE_URL": database_url,
        "INTEGUMENT_BLOBS_URL": blobs_url,
        "INTEGUMENT_DATA_DIR": str(tmp_path / "operator"),
    }
    vault = str(tmp_path / "vault")
    where = tmp_path / "lab"
    where.mkdir()
    with (
        lab(where, database_url, valkey.url, blobs_url=blobs_url, **ONE_AT_A_TIME) as old,
        closing(Service(old.url, old.key)) as first,
    ):
        jobs = work(first)
        (worker,) = old.workers.values()
        worker.send_signal(signal.SIGSTOP)
        before = downloads(first, jobs)
        admin("backup", vault, **variables)
        worker.send_signal(signal.SIGCONT)
    valkey.kill()
    valkey.start()
    destroy_database(postgres, database_url)
    destroy_bucket(seaweed, blobs_url)

    assert admin("restore", vault, "--yes", **variables)["jobs_queued_again"] == 1
    with (
        lab(where, database_url, valkey.url, blobs_url=blobs_url, **ONE_AT_A_TIME) as new,
        closing(Service(new.url, old.key)) as second,
    ):
        assert list(same(downloads(second, jobs), before)) == []
        assert len(before) >= 8
        for job in jobs:
            second.succeed(job)


def destroy_database(postgres: PostgresServer, url: str) -> None:
    name = make_url(url).database
    with psycopg.connect(postgres.url(), autocommit=True) as connection:
        connection.execute(f"DROP DATABASE {name} WITH (FORCE)".encode())
        connection.execute(f"CREATE DATABASE {name}".encode())


def destroy_bucket(seaweed: SeaweedServer, url: str) -> None:
    bucket = S3Place.of(url).bucket
    client = seaweed.client()
    pages = client.get_paginator("list_objects_v2").paginate(Bucket=bucket)
    keys = [row["Key"] for page in pages for row in page.get("Contents", ())]
    assert keys
    for key in keys:
        client.delete_object(Bucket=bucket, Key=key)
