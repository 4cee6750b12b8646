"""Absolute URLs of this server as the client sees it; the Host header was checked before (`api.request_context`)."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import quote, urlencode

from starlette.requests import Request

from api.schemas.link import Link

HANDBOOK = "/handbook/"
BASE = "/v1"
JSON = "application/json"
OPENAPI_3_0 = "application/vnd.oai.openapi+json;version=3.0"
_OGC_RELATIONS = "http://www.opengis.net/def/rel/ogc/1.0/"
PROCESSES_RELATION = _OGC_RELATIONS + "processes"
CONFORMANCE_RELATION = _OGC_RELATIONS + "conformance"
EXECUTE_RELATION = _OGC_RELATIONS + "execute"
JOB_LIST_RELATION = _OGC_RELATIONS + "job-list"
RESULTS_RELATION = _OGC_RELATIONS + "results"

_BASE_KEY = "integument.base"  # of ASGI's scope

Query = Sequence[tuple[str, str]]


def absolute(request: Request, path: str, query: Query = ()) -> str:
    """The URL of `path` (starts with /v1) on this server; query values are escaped."""
    base: str | None = request.scope.get(_BASE_KEY)
    if base is None:  # once per request: a document has many links
        base = request.scope[_BASE_KEY] = str(request.base_url).rstrip("/")
    return base + quote(path) + (f"?{urlencode(query)}" if query else "")


def link(request: Request, path: str, rel: str, *, media_type: str | None = JSON, title: str | None = None) -> Link:
    """A link to `path` of this server."""
    return Link(href=absolute(request, path), rel=rel, type=media_type, title=title)


def job_path(job_id: str) -> str:
    """Where a job lives; also its `Location`."""
    return f"{BASE}/jobs/{job_id}"


def upload_path(upload_id: str) -> str:
    """Where an upload in pieces goes to; also its `Location`."""
    return f"{BASE}/uploads/{upload_id}"


def mesh_path(mesh_id: str) -> str:
    """Where a mesh lives; also its `Location`."""
    return f"{BASE}/meshes/{mesh_id}"
