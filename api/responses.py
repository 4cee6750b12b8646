"""Declared answers, for OpenAPI; `api.openapi` gives problems their media type."""

from __future__ import annotations

from typing import Any

from api.schemas.problem import Problem

Responses = dict[int | str, dict[str, Any]]

_MEANINGS = {
    400: "The request cannot be understood",
    401: "An API key is asked for, and this is none that is good",
    403: "The API key does not allow this, or the workspace is full",
    404: "There is no such thing",
    409: "The state of the thing forbids it",
    412: "Another version of tus is spoken here",
    413: "Larger than this server takes, or too costly to read",
    415: "Not a media type this route takes",
    416: "The range lies behind the end of the file",
    423: "Another request has it; try again",
    422: "The request is at fault, `errors` and `findings` say where",
    429: "Too many requests or jobs of this workspace; `Retry-After` says when to try again",
    460: "The checksum is another; nothing was kept of the request",
    500: "The server is at fault",
    503: "Not now; try again",
    507: "The disk of the server is full",
}


def problems(*statuses: int) -> Responses:
    """The problems a route may answer with; 400 (Host, malformed) and 500 go without saying."""
    return {status: {"model": Problem, "description": _MEANINGS[status]} for status in sorted({400, 500, *statuses})}


def files(description: str, *media_types: str) -> Responses:
    """A download: whole, in part, or unchanged."""
    content = {media_type: {"schema": {"type": "string", "format": "binary"}} for media_type in media_types}
    return {
        200: {"description": description, "content": content},
        206: {"description": "The range asked for", "content": content},
        304: {"description": "Unchanged since the ETag sent in If-None-Match"},
        **problems(404, 416),
    }
