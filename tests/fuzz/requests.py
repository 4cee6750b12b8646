"""Raw requests to the whole application, in this process: any bytes must be answered, and never by a 5xx."""

from __future__ import annotations

import asyncio
from functools import cache
from urllib.parse import unquote_to_bytes

from fastapi import FastAPI
from starlette.types import Message

from api.app import create_app
from store.settings import Settings
from tests.fuzz.readers import folder

PATIENCE_S = 1.0  # long polls and streams are let go; nothing else waits
NOBODY = "redis://127.0.0.1:1/0"  # a broker that is away is no reason for a 5xx


@cache
def application() -> tuple[FastAPI, asyncio.AbstractEventLoop]:
    """With a database of its own, without its background threads."""
    settings = Settings(data_dir=folder() / "api", broker_url=NOBODY, quota_jobs=0, upload_limit_bytes=64 * 1024)
    app = create_app(settings)
    app.state.services.db.migrate()
    return app, asyncio.new_event_loop()


def send_request(data: bytes) -> None:
    """Raises AssertionError for a 5xx and for an answer that is none. `data`: request line, header lines, blank line, body."""
    head, _, body = data.partition(b"\n\n")
    lines = head.split(b"\n")
    method, _, target = lines[0].partition(b" ")
    headers = [(b"host", b"localhost")]
    for line in lines[1:]:
        name, _, value = line.partition(b":")
        headers.append((name.strip().lower(), value.strip()))
    app, loop = application()
    status = loop.run_until_complete(_ask(app, method.decode("latin-1").upper() or "GET", target, headers, body))
    if status == 503 and b"readyz" in target:  # the broker is away, and it says so
        return
    if status is not None and not 200 <= status < 500:
        raise AssertionError(f"answered with {status}")


async def _ask(app: FastAPI, method: str, target: bytes, headers: list[tuple[bytes, bytes]], body: bytes) -> int | None:
    path, _, query = target.partition(b"?")
    scope = {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": method,
        "scheme": "http",
        "path": unquote_to_bytes(path).decode("utf-8", "replace"),
        "raw_path": path,
        "root_path": "",
        "query_string": query,
        "headers": headers,
        "client": ("127.0.0.1", 50000),
        "server": ("127.0.0.1", 8000),
        "state": {},
    }
    inbox: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]
    status: list[int] = []

    async def receive() -> Message:
        return inbox.pop() if inbox else {"type": "http.disconnect"}

    async def send(message: Message) -> None:
        if message["type"] == "http.response.start":
            status.append(message["status"])

    try:
        async with asyncio.timeout(PATIENCE_S):
            await app(scope, receive, send)
    except TimeoutError:
        return None
    if len(status) != 1:
        raise AssertionError(f"{len(status)} answers")
    return status[0]


def seeds_of_requests() -> tuple[bytes, ...]:
    """One request for every route that is described, with the parameters and body it takes."""
    app, _ = application()
    found = []
    identity = "00000000-0000-4000-8000-000000000000"
    for path, methods in app.openapi()["paths"].items():
        for method, said in methods.items():
            target, headers = path.replace("{process_id}", "shells").replace("{output}", "report"), []
            for name in ("mesh_id", "job_id", "upload_id"):
                target = target.replace("{" + name + "}", identity)
            for parameter in said.get("parameters", ()):
                if parameter["in"] == "header":
                    headers.append(f"{parameter['name']}: {_HEADERS.get(parameter['name'].lower(), '5')}")
                if parameter["in"] == "query":
                    target += ("&" if "?" in target else "?") + f"{parameter['name']}=10"
            media_type = next(iter(said.get("requestBody", {}).get("content", {})), None)
            if media_type is not None:
                headers.append(f"Content-Type: {media_type}" + ('; boundary="x"' if "multipart" in media_type else ""))
            body = _BODIES.get(media_type or "", "")
            found.append("\n".join([f"{method} {target}", *headers, "", body]).encode())
    return tuple(found)


_HEADERS = {
    "tus-resumable": "1.0.0",
    "upload-metadata": "filename c2tpbi5zdGw=,unit bW0=",
    "upload-checksum": "sha256 47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=",
    "idempotency-key": "once",
    "prefer": "wait=0, respond-async",
}
_BODIES = {
    "application/json": '{"inputs": {"skin": {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}, "layers": '
    '[{"name": "fat", "depth_mm": 1.0}]}, "outputs": {"report": {"transmissionMode": "reference"}}, "response": "document"}',
    "multipart/form-data": '--x\r\nContent-Disposition: form-data; name="file"; filename="skin.stl"\r\n\r\nsolid\r\n'
    '--x\r\nContent-Disposition: form-data; name="unit"\r\n\r\nmm\r\n--x--\r\n',
    "application/offset+octet-stream": "solid",
}
