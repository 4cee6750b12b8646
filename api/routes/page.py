"""The web page for people, `/`, and the documentation, `/handbook/`. They hold nothing of anybody, so they ask for no key."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from fastapi import APIRouter, Request
from starlette.responses import RedirectResponse, Response

from api.handbook_files import find_handbook, read_handbook_file
from api.links import HANDBOOK
from api.page_files import PageFile, read_page
from core.errors import StateError

# the page runs its own scripts, talks to its own server, and nothing else; pictures it draws itself are data and blobs
PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
FOR_EVER = "public, max-age=31536000, immutable"  # the name of an asset changes with its content
ASK_AGAIN = "no-cache"


def page_router(files: Mapping[str, PageFile] | None = None) -> APIRouter:
    """A route for every file there is, so no path of a request ever reaches the disk."""
    found = read_page() if files is None else files
    router = APIRouter(include_in_schema=False)
    router.add_api_route("/", _send(found["/"], ASK_AGAIN) if found else _not_built, methods=["GET", "HEAD"])
    for path in found:
        if path != "/":
            router.add_api_route(path, _send(found[path], FOR_EVER), methods=["GET", "HEAD"])
    return router


def _send(file: PageFile, cached: str) -> Callable[[Request], Response]:
    """The endpoint of one file."""

    def send(request: Request) -> Response:
        return _answer(request, file, cached, PAGE_POLICY)

    return send


def _answer(request: Request, file: PageFile, cached: str, policy: str) -> Response:
    headers = {"Cache-Control": cached, "ETag": file.etag, "Vary": "Accept-Encoding", "Content-Security-Policy": policy}
    if request.headers.get("if-none-match") == file.etag:
        return Response(status_code=304, headers=headers)
    content = file.content
    if file.packed is not None and "gzip" in request.headers.get("accept-encoding", ""):
        content, headers["Content-Encoding"] = file.packed, "gzip"
    headers["Content-Length"] = str(len(content))
    return Response(b"" if request.method == "HEAD" else content, headers=headers, media_type=file.media_type)


def handbook_router(files: Mapping[str, Path] | None = None) -> APIRouter:
    """Files are looked up by name, so no path of a request ever reaches the disk."""
    found = find_handbook() if files is None else files
    router = APIRouter(include_in_schema=False)

    def send(request: Request, path: str) -> Response:
        if not found:
            said = "The documentation was not built: run `make docs` in the source tree and start the server again"
            raise StateError("handbook.not_built", said)
        if path not in found:
            raise StateError("handbook.not_found", f"The documentation has no page '{path[:200]}'; it begins at {HANDBOOK}")
        file, policy = read_handbook_file(found[path])
        return _answer(request, file, ASK_AGAIN, policy)

    router.add_api_route(HANDBOOK.rstrip("/"), lambda: RedirectResponse(HANDBOOK, 308), methods=["GET", "HEAD"])
    router.add_api_route(HANDBOOK + "{path:path}", send, methods=["GET", "HEAD"])
    return router


def _not_built() -> Response:
    """Never an empty page: say what is missing and who can mend it."""
    raise StateError(
        "page.not_built",
        "The web page was not built: run `make web` in the source tree and start the server again. The API is at /v1",
    )
