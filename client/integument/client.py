"""The Python client."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self
from urllib.parse import urlsplit
from uuid import uuid4

from integument.answer import read_json
from integument.api_key import key_of_environment
from integument.cohort_requests import CohortRequests
from integument.download import download, offered_file_name
from integument.errors import ArgumentError, JobDismissedError, JobFailedError, ReplyError, WaitTimeoutError
from integument.event import JobEvent
from integument.follow import follow_events, past_events
from integument.job import Job
from integument.layer import as_layer
from integument.mesh import Mesh
from integument.preparation import Preparation
from integument.process import Process
from integument.region import Region
from integument.report import Report
from integument.result import Output, Results
from integument.surface_processes import MeshInput, OnEvent, SurfaceProcesses, Unit
from integument.transport import Transport
from integument.upload import OnBytes, Source, opened

DEFAULT_URL = "http://127.0.0.1:8000"
INTAKE_TIMEOUT_S = 300.0  # an upload is answered when the server has read and checked the mesh


class Client(SurfaceProcesses, Preparation, CohortRequests):
    """Talks to one server.

    url: the server; without it INTEGUMENT_URL, else http://127.0.0.1:8000, where `integument serve` listens.
    api_key: without it INTEGUMENT_API_KEY; a server on this machine that asks for none does not look at it.
    timeout_s: how long one answer may take. retries: how often a broken connection, 429, 502, 503 or 504 is tried again.
    All methods raise ServerUnreachableError when no answer came in the end, and ProblemError when the server refused.
    """

    def __init__(
        self,
        url: str | None = None,
        *,
        api_key: str | None = None,
        timeout_s: float = 30.0,
        retries: int = 5,
        first_pause_s: float = 0.25,
    ) -> None:
        address = url or os.environ.get("INTEGUMENT_URL") or DEFAULT_URL
        self._transport = Transport(
            address,
            api_key=api_key or key_of_environment(),
            timeout_s=timeout_s,
            retries=retries,
            first_pause_s=first_pause_s,
        )

    @property
    def url(self) -> str:
        """The server's root."""
        return self._transport.url

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections; jobs go on."""
        self._transport.close()

    # meshes

    def upload_mesh(self, source: Source, *, unit: Unit = "mm", name: str | None = None, on_bytes: OnBytes | None = None) -> Mesh:
        """Send a file (path, bytes or open file), streamed from disk; `unit` is that of its coordinates.

        Raises: ArgumentError (file unreadable), ProblemError (the server cannot read the mesh: codes `stl.*`, `mat.*`, ...).
        """
        fields = {"unit": unit} | ({"name": name} if name else {})
        headers = {"Idempotency-Key": str(uuid4())}  # the same for all tries, so the server sees one upload
        with opened(source, on_bytes) as (file, file_name):
            response = self._transport.request(
                "POST",
                "/v1/meshes",
                data=fields,
                files={"file": (file_name, file, "application/octet-stream")},
                headers=headers,
                read_timeout_s=INTAKE_TIMEOUT_S,
            )
        return Mesh.read(read_json(response), "the uploaded mesh")

    def mesh(self, mesh_id: str) -> Mesh:
        """One mesh."""
        return Mesh.read(self._get(f"/v1/meshes/{mesh_id}"), "the mesh")

    def meshes(self, *, text: str = "", limit: int | None = None) -> Iterator[Mesh]:
        """The newest first; further pages are fetched as needed. text: every word of it occurs in the name."""
        wanted = {"q": text} if text else {}
        return (Mesh.read(item, "a mesh of the list") for item in self._pages("/v1/meshes", "meshes", wanted, limit))

    # processes

    def processes(self) -> list[Process]:
        """What this server can do, in short."""
        return [Process.read(item, "a process of the list") for item in self._pages("/v1/processes", "processes", {}, None)]

    def process(self, process_id: str) -> Process:
        """One process with the JSON Schemas of its inputs."""
        return Process.read(self._get(f"/v1/processes/{process_id}"), "the process description")

    def execute(
        self,
        process_id: str,
        inputs: Mapping[str, Any],
        *,
        name: str | None = None,
        labels: Sequence[str] = (),
        idempotency_key: str | None = None,
    ) -> Job:
        """Queue a job, with a name and labels to find it by.

        The idempotency key makes a repeated request one job; without one a fresh one is made per call.

        Raises: ArgumentError (inputs that are no JSON, as NaN is not); ProblemError, with the place of each wrong input
        in `problem.errors`.
        """
        try:
            words: dict[str, Any] = ({"name": name} if name else {}) | ({"labels": list(labels)} if labels else {})
            body = json.dumps({"inputs": dict(inputs), **words}, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise ArgumentError(f"the inputs are no JSON: {error}") from error
        headers = {
            "Content-Type": "application/json",
            "Idempotency-Key": idempotency_key or str(uuid4()),
            "Prefer": "respond-async",
        }
        response = self._transport.request("POST", f"/v1/processes/{process_id}/execution", content=body, headers=headers)
        return Job.read(read_json(response), "the new job")

    # jobs

    def job(self, job_id: str) -> Job:
        """How the job stands."""
        return Job.read(self._get(f"/v1/jobs/{job_id}"), "the job")

    def jobs(
        self,
        *,
        status: str | None = None,
        process: str | None = None,
        labels: Sequence[str] = (),
        text: str = "",
        limit: int | None = None,
    ) -> Iterator[Job]:
        """The newest first; further pages are fetched as needed.

        labels: all of them. text: every word of it occurs in name, labels, process, id or names of meshes."""
        asked = {"status": status, "processID": process, "label": list(labels), "q": text}
        wanted = {key: value for key, value in asked.items() if value}
        return (Job.read(item, "a job of the list") for item in self._pages("/v1/jobs", "jobs", wanted, limit))

    def relabel(self, job: Job | str, *, name: str | None = None, labels: Sequence[str] | None = None) -> Job:
        """Give a job another name (an empty one takes it away) or other labels; None leaves them."""
        change = ({} if name is None else {"name": name or None}) | ({} if labels is None else {"labels": list(labels)})
        return Job.read(read_json(self._transport.request("PATCH", f"/v1/jobs/{_id(job)}", json=change)), "the job")

    def events(self, job: Job | str, *, after: str = "", follow: bool = True) -> Iterator[JobEvent]:
        """What happened to the job after event number `after`, and goes on happening, up to its end.

        Broken connections are replaced; every event comes once and in order. follow: false ends with what there is now.
        """
        job_id = _id(job)
        if not follow:
            return past_events(self._transport, job_id, after=after)
        return follow_events(self._transport, job_id, look=lambda: self.job(job_id), after=after)

    def wait(self, job: Job | str, on_event: OnEvent | None = None, *, timeout_s: float | None = None) -> Job:
        """Wait for the end and return the successful job (its verdict may still be `not_ready`).

        Raises: JobFailedError, JobDismissedError; WaitTimeoutError after `timeout_s`, looked at with every event.
        """
        deadline = None if timeout_s is None else time.monotonic() + timeout_s
        job_id = _id(job)
        for event in self.events(job_id):
            if on_event is not None:
                on_event(event)
            if deadline is not None and timeout_s is not None and time.monotonic() > deadline:
                raise WaitTimeoutError(job_id, timeout_s)
        finished = self.job(job_id)
        if finished.status == "failed":
            raise JobFailedError(finished)
        if finished.status == "dismissed":
            raise JobDismissedError(finished)
        if not finished.done:
            raise ReplyError(f"the events of job {job_id} ended, but its status is {finished.status}")
        return finished

    def dismiss(self, job: Job | str) -> Job:
        """Cancel a waiting or running job.

        Raises: ArgumentError if it is finished: the same request would then remove it with all it made, see `remove`.
        """
        current = self.job(_id(job))
        if current.done:
            raise ArgumentError(f"job {current.id} is already {current.status}")
        # it may end just now; not repeatable: an older server does not know `keep_ended`, and would remove it
        response = self._transport.request("DELETE", f"/v1/jobs/{current.id}?keep_ended=true", repeatable=False)
        return Job.read(read_json(response), "the dismissed job")

    def remove(self, job: Job | str) -> None:
        """Remove a finished job and what it made.

        Raises: ArgumentError if it is not finished, see `dismiss`.
        """
        current = self.job(_id(job))
        if not current.done:
            raise ArgumentError(f"job {current.id} is still {current.status}")
        self._transport.request("DELETE", f"/v1/jobs/{current.id}", repeatable=False)

    def retry(self, job: Job | str) -> Job:
        """Queue a failed or dismissed job once more, under the same id."""
        headers = {"Idempotency-Key": str(uuid4())}
        return Job.read(
            read_json(self._transport.request("POST", f"/v1/jobs/{_id(job)}/retry", headers=headers)), "the retried job"
        )

    # what jobs made

    def results(self, job: Job | str) -> Results:
        """The outputs of a successful job."""
        return Results.read(self._get(f"/v1/jobs/{_id(job)}/results"))

    def download(self, job: Job | str, output: str, path: str | os.PathLike[str], *, on_bytes: OnBytes | None = None) -> Path:
        """One output into a file, or into a folder under the name the server gives it.

        Goes on where an earlier, broken call stopped; the file appears under its name only when complete and intact.
        Raises: DownloadCorruptError, OSError.
        """
        source = f"/v1/jobs/{_id(job)}/results/{output}"
        target = Path(path)
        if target.is_dir():
            target /= offered_file_name(self._transport, source)
        return download(self._transport, source, target, on_bytes)

    def report(self, job: Job | str) -> Report:
        """Numbers and findings; failed jobs have one too."""
        return Report.read(self._get(f"/v1/jobs/{_id(job)}/report"), "the report")

    def report_html(self, job: Job | str) -> str:
        """The report as one self-contained page."""
        return self._transport.request("GET", f"/v1/jobs/{_id(job)}/report", headers={"Accept": "text/html"}).text

    # the whole way in one call

    def shells(
        self,
        skin: MeshInput,
        layers: Mapping[str, float | str] | None = None,
        regions: Sequence[Region] = (),
        *,
        outer_layers: Mapping[str, float | str] | None = None,
        unit: Unit = "mm",
        thin_policy: Literal["adapt", "fail"] = "adapt",
        min_gap_mm: float | None = None,
        skin_shift_mm: float | None = None,
        on_event: OnEvent | None = None,
    ) -> Job:
        """Nested shells inside a skin, and around it: uploads it if needed, queues the job and waits.

        layers: name -> depth in mm, or the name of an array of a MAT upload with the depth at each vertex, from outside
        inwards. outer_layers: the same for layers around the skin. Without any, fat 1 mm and average_body 3 mm inside.
        Raises: as `upload_mesh`, `execute` and `wait`.
        """
        inputs: dict[str, Any] = {"skin": self._reference(skin, unit), "thin_policy": thin_policy}
        if layers is not None or outer_layers is not None:
            inputs["layers"] = [
                *(as_layer(name, depth, "outside") for name, depth in (outer_layers or {}).items()),
                *(as_layer(name, depth) for name, depth in (layers or {}).items()),
            ]
        if regions:
            inputs["regions"] = [region.as_input() for region in regions]
        if min_gap_mm is not None:
            inputs["min_gap_mm"] = min_gap_mm
        if skin_shift_mm is not None:
            inputs["skin_shift_mm"] = skin_shift_mm
        return self.wait(self.execute("shells", inputs), on_event)

    def validate(
        self,
        meshes: Mapping[str, MeshInput] | MeshInput,
        *,
        unit: Unit = "mm",
        min_gap_mm: float | None = None,
        on_event: OnEvent | None = None,
    ) -> Job:
        """Check one mesh, or a named set also against each other: uploads what is needed, queues the job and waits.

        Raises: as `upload_mesh`, `execute` and `wait`. A mesh found unfit is no error: the job's verdict is `not_ready`.
        """
        if isinstance(meshes, Mapping):
            references: Any = {name: self._reference(mesh, unit) for name, mesh in meshes.items()}
        else:
            references = self._reference(meshes, unit)
        inputs = {"meshes": references} | ({} if min_gap_mm is None else {"min_gap_mm": min_gap_mm})
        return self.wait(self.execute("validate", inputs), on_event)

    def _reference(self, mesh: MeshInput, unit: Unit) -> dict[str, str]:
        if isinstance(mesh, Mesh | Output):
            return {"href": mesh.href}
        if isinstance(mesh, str) and mesh.startswith("/v1/"):
            return {"href": mesh}
        return {"href": self.upload_mesh(mesh, unit=unit).href}

    def _get(self, path: str, params: Mapping[str, Any] | None = None) -> Any:
        response = self._transport.request("GET", path, params=params, headers={"Accept": "application/json"})
        return read_json(response)

    def _pages(self, path: str, key: str, params: Mapping[str, Any], limit: int | None) -> Iterator[Any]:
        """The items of a list over all pages, at most `limit`. Only path and query of `next` count: never another server."""
        left = limit
        query: Mapping[str, Any] | None = dict(params) | ({} if limit is None else {"limit": str(min(limit, 100))})
        while True:
            document = self._get(path, query)
            if not isinstance(document, dict) or not isinstance(document.get(key), list):
                raise ReplyError(f"{path} answered no list of {key}")
            for item in document[key]:
                if left is not None and left <= 0:
                    return
                left = None if left is None else left - 1
                yield item
            following = _next_link(document.get("links") or ())
            if following is None or left == 0:
                return
            path, query = following, None


def _id(job: Job | str) -> str:
    return job.id if isinstance(job, Job) else job


def _next_link(links: Iterable[Mapping[str, Any]]) -> str | None:
    for link in links:
        if link.get("rel") == "next" and link.get("href"):
            parts = urlsplit(str(link["href"]))
            return f"{parts.path}?{parts.query}" if parts.query else parts.path
    return None
