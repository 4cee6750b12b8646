"""A real API on a loopback port, in a thread, with its services at hand: tests play the worker through the store."""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import uvicorn

from api.app import create_app
from api.guarded_connection import guarded_connections
from api.services import Services
from store.job import Job, JobFailure, JobOutput
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

REPORT = b'{"process": "validate", "verdict": "simulation_ready", "summary": "1 mesh, no errors"}'
REPORT_HTML = b"<!doctype html><title>Report</title><h1>1 mesh, no errors</h1>"


@dataclass(frozen=True)
class Live:
    """A serving application."""

    url: str
    services: Services
    client: httpx.Client

    @property
    def data_dir(self) -> Path:
        """Where it keeps everything."""
        return self.services.settings.data_dir

    def upload(self, data: bytes, file_name: str = "skin.stl", **fields: str) -> httpx.Response:
        """Send a mesh."""
        return self.client.post("/v1/meshes", files={"file": (file_name, data)}, data=fields)

    def mesh_href(self, data: bytes) -> str:
        """Send a mesh that is taken, and say where it is."""
        response = self.upload(data)
        assert response.status_code == 201, response.text
        return str(response.headers["Location"])

    def execute(self, process: str, inputs: Mapping[str, Any], **headers: str) -> httpx.Response:
        """Start a job."""
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        return self.client.post(f"/v1/processes/{process}/execution", json={"inputs": dict(inputs)}, headers=named)

    def accepted(self, process: str = "validate", workspace: WorkspaceId = DEFAULT_WORKSPACE) -> Job:
        """A job that waits, put into the table."""
        return self.services.jobs.create(workspace, process, {})

    def announced(self, job_id: str) -> Job:
        """The job, as soon as the workers were told of it: a thread does that a moment after the answer."""
        deadline = time.monotonic() + 10
        while (job := self.services.jobs.get(DEFAULT_WORKSPACE, job_id)).rung_at is None:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        return job

    def running(self, process: str = "validate", workspace: WorkspaceId = DEFAULT_WORKSPACE) -> Job:
        """A job a worker holds."""
        job = self.services.jobs.claim(self.accepted(process, workspace).id, 1, "tests", 60.0)
        assert job is not None
        return job

    def successful(
        self,
        outputs: Mapping[str, tuple[bytes, str, str]] | None = None,
        *,
        workspace: WorkspaceId = DEFAULT_WORKSPACE,
        process: str = "validate",
    ) -> Job:
        """A job that made these outputs: name -> (bytes, media type, file name)."""
        made = outputs or {
            "report": (REPORT, "application/json", "report.json"),
            "report_html": (REPORT_HTML, "text/html", "report.html"),
        }
        job = self.running(process, workspace=workspace)
        kept = self.services.jobs.finish(
            job.id,
            job.lease_token,
            verdict="simulation_ready",
            summary="1 mesh, no errors",
            outputs={name: self.stored(*told) for name, told in made.items()},
            timings_s={"validate": 0.25},
            peak_memory_bytes=123_456_789,
        )
        assert kept
        return self.services.jobs.get(workspace, job.id)

    def failed(
        self, failure: JobFailure, *, report: bool = True, left: Mapping[str, tuple[bytes, str, str]] | None = None
    ) -> Job:
        """A job that failed; left: name -> (bytes, media type, file name)."""
        job = self.running("shells")
        outputs = {name: self.stored(*told) for name, told in (left or {}).items()}
        if report:
            outputs["report"] = self.stored(REPORT, "application/json", "report.json")
        ended = self.services.jobs.fail(job.id, job.lease_token, failure, outputs=outputs, timings_s={"shells": 1.5})
        assert ended is not None
        return ended

    def stored(self, data: bytes, media_type: str, file_name: str) -> JobOutput:
        """Bytes among the blobs."""
        blob = self.services.blobs.put_bytes(data)
        return JobOutput(blob.sha256, blob.size, media_type, file_name)

    def blob_names(self) -> set[str]:
        """All blobs."""
        return {blob.sha256 for blob in self.services.blobs.all()}

    def is_clean(self) -> bool:
        """True as soon as no request has a folder any more: a download's goes right after its last byte."""
        deadline = time.monotonic() + 10
        while self.incoming() and time.monotonic() < deadline:
            time.sleep(0.02)
        return self.incoming() == []

    def incoming(self) -> list[Path]:
        """What lies where uploads come in; it may be on its way out while we look."""
        walked = os.walk(self.services.incoming_dir)
        return sorted(Path(folder) / name for folder, folders, files in walked for name in (*folders, *files))


@contextmanager
def serving(settings: Settings) -> Iterator[Live]:
    """Serve until the block ends."""
    app = create_app(settings)
    listener = socket.socket()
    listener.bind(("127.0.0.1", 0))
    url = f"http://127.0.0.1:{listener.getsockname()[1]}"
    config = uvicorn.Config(
        app, http=guarded_connections(settings), log_level="warning", lifespan="on", timeout_graceful_shutdown=5
    )
    server = uvicorn.Server(config)
    started = threading.Event()
    thread = threading.Thread(target=_run, args=(server, listener, started))
    thread.start()
    assert started.wait(30)
    try:
        with httpx.Client(base_url=url, timeout=60, trust_env=False) as client:
            yield Live(url, app.state.services, client)
    finally:
        app.state.services.drain.begin()
        server.should_exit = True
        thread.join(30)
        listener.close()
    assert not thread.is_alive()


def _run(server: uvicorn.Server, listener: socket.socket, started: threading.Event) -> None:
    startup = server.startup

    async def announce(sockets: list[socket.socket] | None = None) -> None:
        await startup(sockets)
        started.set()

    server.startup = announce  # type: ignore[method-assign]
    server.run(sockets=[listener])


def problem_of(response: httpx.Response, status: int, code: str) -> dict[str, Any]:
    """The problem, after looking at everything all of them share."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    assert response.headers["cache-control"] == "no-store"
    problem: dict[str, Any] = response.json()
    assert problem["code"] == code, problem
    assert problem["status"] == status
    assert problem["type"].startswith(("urn:integument:problem:", "http://www.opengis.net/def/exceptions/"))
    assert problem["title"]
    assert problem["detail"]
    assert problem["instance"] == httpx.URL(response.request.url).path
    assert problem["request_id"] == response.headers["x-request-id"]
    assert isinstance(problem["retryable"], bool)
    return problem
