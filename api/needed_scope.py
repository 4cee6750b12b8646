"""What a request must be allowed to do; by method and path alone, so no route can be added without it."""

from __future__ import annotations

from api.links import HANDBOOK
from store.scope import Scope

OPEN_PATHS = frozenset({"/healthz", "/readyz", "/", HANDBOOK.rstrip("/")})  # for supervisors, balancers, people: no work in it
PUBLIC_FILES = ("/assets/", HANDBOOK)  # a browser cannot send a key with what a page is made of, or with a link it follows
ADMIN_PATHS = frozenset({"/metrics"})  # counts the work of all workspaces
UPLOADS = "/v1/uploads"  # sending a file in pieces is all writing, also where its protocol asks how far it is
_READING = frozenset({"GET", "HEAD", "OPTIONS"})


def needed_scope(method: str, path: str) -> Scope | None:
    """None: open to everybody. A path that leads nowhere asks for a key too."""
    if path in OPEN_PATHS or path.startswith(PUBLIC_FILES):
        return None
    if path in ADMIN_PATHS:
        return Scope.ADMIN
    if path == UPLOADS or path.startswith(f"{UPLOADS}/"):
        return Scope.SUBMIT
    return Scope.READ if method.upper() in _READING else Scope.SUBMIT
