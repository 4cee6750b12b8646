"""A small real HTTP server that keeps the contract of the API, and breaks connections where a test tells it to."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import threading
from collections import defaultdict, deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from email.parser import BytesParser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

JOB_ID = "11111111-1111-4111-8111-111111111111"
MESH_ID = "22222222-2222-4222-8222-222222222222"


@dataclass
class Seen:
    method: str
    path: str
    headers: dict[str, str]
    body: bytes


@dataclass
class Refuse:
    """Answer with a problem instead of doing anything."""

    status: int
    code: str = "server.busy"
    retry_after: str | None = None
    text: str | None = None


@dataclass
class Drop:
    """Close the connection without a word; `after_work`: the request was carried out, only its answer is lost."""

    after_work: bool = False


@dataclass
class Cut:
    """Send the headers and so many bytes of the body, then close."""

    bytes: int


@dataclass
class SendOn:
    """Point to another place, as a server does whose files are in an object store."""

    url: str


Fault = Refuse | Drop | Cut | SendOn


@dataclass
class State:
    faults: dict[str, deque[Fault]] = field(default_factory=lambda: defaultdict(deque))
    seen: list[Seen] = field(default_factory=list)
    answered: dict[str, tuple[int, dict[str, Any]]] = field(default_factory=dict)
    uploads: list[dict[str, Any]] = field(default_factory=list)
    jobs: dict[str, dict[str, Any]] = field(default_factory=dict)
    events: list[tuple[int, str, dict[str, Any]]] = field(default_factory=list)
    stops: deque[int] = field(default_factory=deque)
    """Sequence numbers behind which an event stream is cut, one per connection."""
    files: dict[str, bytes] = field(default_factory=dict)
    stated: dict[str, str] = field(default_factory=dict)
    """SHA-256 to state for a path in place of the true one."""
    report: dict[str, Any] | None = None
    endless_events: bool = False
    after_retry: str = "accepted"

    def requests(self, method: str, path: str) -> list[Seen]:
        return [item for item in self.seen if item.method == method and item.path.split("?")[0] == path]

    def add_job(self, status: str = "running", job_id: str = JOB_ID, **more: Any) -> dict[str, Any]:
        self.jobs[job_id] = {"jobID": job_id, "processID": "shells", "type": "process", "status": status, "attempt": 1, **more}
        return self.jobs[job_id]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    state: State

    def log_message(self, *_arguments: object) -> None:
        """Quiet."""

    def do_GET(self) -> None:
        self._serve()

    do_POST = do_DELETE = do_HEAD = do_GET

    def _serve(self) -> None:
        body = self.rfile.read(int(self.headers.get("content-length", 0)))
        path = urlsplit(self.path).path
        self.state.seen.append(Seen(self.command, self.path, {k.lower(): v for k, v in self.headers.items()}, body))
        queue = self.state.faults[f"{self.command} {path}"]
        fault = queue.popleft() if queue else None
        if isinstance(fault, Drop) and not fault.after_work:
            self.close_connection = True
        elif isinstance(fault, Refuse):
            self._refuse(fault)
        elif isinstance(fault, SendOn):
            self._bytes(307, b"", "text/plain", {"Location": fault.url})
        elif path in self.state.files:
            self._file(path, fault)
        elif path.endswith("/events"):
            self._events(path)
        else:
            status, document = self._answer(path, body)
            if isinstance(fault, Drop):
                self.close_connection = True
                return
            self._json(status, document)

    def _answer(self, path: str, body: bytes) -> tuple[int, dict[str, Any]]:
        key = self.headers.get("idempotency-key")
        if key in self.state.answered:
            return self.state.answered[key]
        status, document = self._act(path, body)
        if key:
            self.state.answered[key] = (status, document)
        return status, document

    def _act(self, path: str, body: bytes) -> tuple[int, dict[str, Any]]:
        state = self.state
        if self.command == "POST" and path == "/v1/meshes":
            state.uploads.append(read_form(self.headers["content-type"], body))
            return 201, {"id": MESH_ID, "name": "skin", "file_name": "skin.stl", "unit": "mm", "faces": 12, "vertices": 8}
        if self.command == "POST" and path.endswith("/execution"):
            return 201, state.add_job(inputs=json.loads(body)["inputs"])
        job = re.fullmatch(r"/v1/jobs/([^/]+)(/report|/retry|/results)?", path)
        if path == "/v1/jobs":
            return 200, self._page()
        if path == "/v1/processes":
            return 200, {"processes": [{"id": "shells", "version": "1.0.0", "title": "Shells"}], "links": []}
        if job and job[1] in state.jobs:
            return self._job(job[1], job[2])
        return 404, {"code": "job.not_found", "title": "Not found", "status": 404, "detail": f"no {path}"}

    def _job(self, job_id: str, part: str | None) -> tuple[int, dict[str, Any]]:
        job = self.state.jobs[job_id]
        if part == "/report":
            missing = {"code": "job.no_report", "title": "Not found", "status": 404, "detail": "none"}
            return (404, missing) if self.state.report is None else (200, self.state.report)
        if part == "/results":
            return 200, {"package": {"href": f"{self.path}/package", "type": "application/zip"}, "verdict": "simulation_ready"}
        if part == "/retry":
            job |= {"status": self.state.after_retry, "attempt": job["attempt"] + 1}
        if self.command == "DELETE":
            job["status"] = "dismissed"
        return 200, job

    def _page(self) -> dict[str, Any]:
        query = parse_qs(urlsplit(self.path).query)
        start, size = int(query.get("cursor", ["0"])[0]), int(query.get("limit", ["2"])[0])
        jobs = list(self.state.jobs.values())
        following = f"http://elsewhere.example/v1/jobs?cursor={start + size}&limit={size}"
        links = [{"rel": "next", "href": following}] if start + size < len(jobs) else []
        return {"jobs": jobs[start : start + size], "links": links}

    def _refuse(self, fault: Refuse) -> None:
        headers = {} if fault.retry_after is None else {"Retry-After": fault.retry_after}
        if fault.text is not None:
            self._bytes(fault.status, fault.text.encode(), "text/html", headers)
            return
        problem = {"title": "No", "status": fault.status, "detail": "not now", "code": fault.code}
        self._bytes(fault.status, json.dumps(problem).encode(), "application/problem+json", headers)

    def _json(self, status: int, document: dict[str, Any]) -> None:
        kind = "application/json" if status < 400 else "application/problem+json"
        self._bytes(status, json.dumps(document).encode(), kind, {})

    def _bytes(self, status: int, body: bytes, kind: str, headers: dict[str, str], cut: int | None = None) -> None:
        self.send_response(status)
        for name, value in {"Content-Type": kind, "Content-Length": str(len(body)), **headers}.items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body if cut is None else body[:cut])
        if cut is not None:
            self.close_connection = True

    def _file(self, path: str, fault: Fault | None) -> None:
        content = self.state.files[path]
        digest = self.state.stated.get(path) or hashlib.sha256(content).hexdigest()
        headers = {
            "ETag": f'"{digest}"',
            "Repr-Digest": f"sha-256=:{base64.b64encode(bytes.fromhex(digest)).decode()}:",
            "Content-Disposition": 'attachment; filename="../../package.zip"',
        }
        status, body = 200, content
        wanted = re.fullmatch(r"bytes=(\d+)-", self.headers.get("range", ""))
        if wanted and self.headers.get("if-range") == headers["ETag"]:
            start = int(wanted[1])
            if start >= len(content):
                self._bytes(416, b"", "application/json", {**headers, "Content-Range": f"bytes */{len(content)}"})
                return
            status, body = 206, content[start:]
            headers["Content-Range"] = f"bytes {start}-{len(content) - 1}/{len(content)}"
        self._bytes(status, body, "application/zip", headers, fault.bytes if isinstance(fault, Cut) else None)

    def _events(self, path: str) -> None:
        if path.split("/")[3] not in self.state.jobs:
            self._json(404, {"code": "job.not_found", "title": "Not found", "status": 404, "detail": f"no {path}"})
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        self.close_connection = True
        self.wfile.write(b"retry: 5\n\n")
        seen = int(self.headers.get("last-event-id", 0))
        stop = self.state.stops.popleft() if self.state.stops else None
        for number, kind, data in self.state.events:
            if number > seen and (stop is None or number <= stop):
                self.wfile.write(f"id: {number}\nevent: {kind}\ndata: {json.dumps(data)}\n\n".encode())
        if stop is not None:
            self.wfile.write(b'id: 9999\nevent: log\ndata: {"cut')  # half an event: must not count
        elif self.state.endless_events:
            self.wfile.flush()
            self.server.closing.wait(20)  # type: ignore[attr-defined]


class _Server(ThreadingHTTPServer):
    daemon_threads = False
    closing: threading.Event


def read_form(content_type: str, body: bytes) -> dict[str, Any]:
    """The parts of a multipart body: name -> bytes."""
    message = BytesParser().parsebytes(b"Content-Type: " + content_type.encode() + b"\r\n\r\n" + body)
    return {
        str(part.get_param("name", header="content-disposition")): part.get_payload(decode=True) for part in message.get_payload()
    }


@contextmanager
def faulty_server() -> Iterator[tuple[str, State]]:
    """(url, what it was asked and what it shall do wrong)."""
    state = State()
    handler: Callable[..., _Handler] = type("Handler", (_Handler,), {"state": state})
    with _Server(("127.0.0.1", 0), handler) as server:
        server.closing = threading.Event()
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}", state
        finally:
            server.closing.set()
            server.shutdown()
            thread.join()
