"""Who gets what: every route for every kind of caller. `python -m tests.api.isolation_matrix` writes docs/isolation.md."""

from __future__ import annotations

import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import Connection, event

from api.needed_scope import needed_scope
from store.settings import Settings
from tests.api.access_lab import MISSING, ROUTES, SCOPED, Lab, concrete, new_cohort, open_lab
from tests.core.io.stl_bytes import binary_stl

PAGE = Path(__file__).parents[2] / "docs" / "isolation.md"
NOBODY = "redis://127.0.0.1:1/0"  # what is asked here needs no broker
TRIES = 3  # once a minute the use of a key is noted, and uploads are swept: a real difference is there each time
HEAD = """\
# Who gets what

Made by `python -m tests.api.isolation_matrix` on a real server with two workspaces and held by
`tests/api/test_isolation.py`: change a route, make it again, and read what changed. Numbers are HTTP statuses.

- *no key*, *read*, *submit*, *admin*: without a key, and with a key of that one scope, on what belongs to its own
  workspace. 401: no key was sent; 403: the scope is missing. Requests have no body (`PATCH` of JSON an empty object,
  `.../cohort` the name of a process), so 409, 412, 415 and 422 mean that the caller was let in and the request was not good.
- *foreign*: a key with all scopes of *another* workspace names what is there. *absent*: the same key names what is not.
- *alike*: both answers are equal byte for byte but for the id asked for, and made the same statements to the database in
  the same order; so neither words nor work tell whether something is there. Time itself is not measured.

| route | needs | no key | read | submit | admin | foreign | absent | alike |
|---|---|---|---|---|---|---|---|---|
"""


@dataclass(frozen=True, slots=True)
class Answer:
    """What somebody saw, and what it took."""

    status: int
    body: str
    headers: tuple[tuple[str, str], ...]
    statements: tuple[str, ...]


def page_of(lab: Lab) -> str:
    """The whole page."""
    routes = [route for route in ROUTES if route[1].startswith(("/v1", "/healthz", "/readyz", "/metrics"))]
    return HEAD + "".join(row(lab, method, path) for method, path in sorted(routes, key=lambda route: (route[1], route[0])))


def row(lab: Lab, method: str, path: str) -> str:
    """One line of the table."""
    need = needed_scope(method, path)
    own = [str(ask(lab, method, own_path(lab, path), role).status) for role in ("nothing", *SCOPED)]
    cells = [f"`{method} {path}`", need.value if need else "nothing", *own]
    if "_id}" in path and "process_id" not in path:
        for _ in range(TRIES):
            foreign = ask(lab, method, concrete(path, lab.mesh, lab.job, lab.upload, lab.cohort), "stranger")
            absent = ask(lab, method, concrete(path), "stranger")
            if foreign == absent:
                break
        cells += [str(foreign.status), str(absent.status), "yes" if foreign == absent else "**no**"]
    else:
        cells += ["", "", ""]
    return "| " + " | ".join(cells) + " |\n"


def own_path(lab: Lab, path: str) -> str:
    """With things of their own for every request: some requests end them."""
    made = {"mesh": lab.mesh, "job": lab.job, "upload": lab.upload, "cohort": lab.cohort}
    if "{mesh_id}" in path:
        made["mesh"] = lab.ask("POST", "/v1/meshes", "owner", files={"file": ("skin.stl", binary_stl())}).json()["id"]
    if "{upload_id}" in path:
        made["upload"] = lab.ask("POST", "/v1/uploads", "owner").json()["id"]
    if "{cohort_id}" in path:
        made["cohort"] = new_cohort(lab.live, lab.workspace)
    if "{job_id}" in path:
        made["job"] = lab.live.successful(workspace=lab.workspace).id
    return concrete(path, **made)


def ask(lab: Lab, method: str, path: str, role: str) -> Answer:
    """One request; ids in the answer are replaced by that of nothing."""
    with statements_of(lab) as statements:
        response = lab.ask(method, path, role)
    told = response.text if "event-stream" not in response.headers.get("content-type", "") else ""
    for known in (lab.mesh, lab.job, lab.upload, lab.cohort, response.headers["x-request-id"]):
        told = told.replace(known, MISSING)
    changing = {"x-request-id", "date", "ratelimit"}
    headers = tuple(sorted((name, value) for name, value in response.headers.items() if name not in changing))
    return Answer(response.status_code, told, headers, tuple(statements))


@contextmanager
def statements_of(lab: Lab) -> Iterator[list[str]]:
    """What goes to the database meanwhile, but for the audit of earlier requests and what the server does by itself."""
    seen: list[str] = []

    def note(_connection: Connection, _cursor: object, statement: str, *_: object) -> None:
        if threading.current_thread().name not in ("audit", "ringer"):
            seen.append(statement)

    event.listen(lab.live.services.db.engine, "before_cursor_execute", note)
    try:
        yield seen
    finally:
        event.remove(lab.live.services.db.engine, "before_cursor_execute", note)


def settings_in(folder: Path) -> Settings:
    """As the table is measured with."""
    return Settings(data_dir=folder, broker_url=NOBODY, rate_per_s=0, event_poll_s=0.05)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder, open_lab(settings_in(Path(folder))) as made:
        made.ask("GET", "/v1", "stranger")
        PAGE.write_text(page_of(made), encoding="utf-8")
