"""Two workspaces on one real server: what the first has, a key of every kind, and every route there is."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path
from typing import Any

import httpx
from sqlalchemy import update

from api.app import create_app
from core.errors import InputError
from core.schema.expectation import UNKNOWN
from store.api_keys import ApiKeys
from store.cohorts import NewCohort, NewSubject
from store.job import JobFailure
from store.key_text import make_key_text
from store.records import ApiKeyRow
from store.scope import Scope
from store.settings import Settings
from store.workspace import WorkspaceId
from store.workspaces import Workspaces
from tests.api.live import Live, serving
from tests.core.io.stl_bytes import binary_stl

MISSING = "00000000-0000-4000-8000-000000000000"
SCOPED = {"read": Scope.READ, "submit": Scope.SUBMIT, "admin": Scope.ADMIN}
TUS = {"Tus-Resumable": "1.0.0", "Upload-Offset": "0", "Upload-Length": "10"}


@dataclass(frozen=True)
class Lab:
    """A server that asks for keys; what `lab-a` has, and a key of every kind."""

    live: Live
    keys: dict[str, str]
    mesh: str
    job: str
    waiting: str
    upload: str
    cohort: str
    workspace: WorkspaceId

    def ask(self, method: str, path: str, role: str, **more: object) -> httpx.Response:
        key = self.keys[role]
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        if "/uploads" in path:
            headers |= TUS
        if method == "PATCH" and "/uploads" in path:
            headers["Content-Type"] = "application/offset+octet-stream"
        elif method == "PATCH" and not more:
            more = {"json": {}}
        elif path.endswith("/cohort") and not more:
            more = {"json": {"process": "validate"}}
        with self.live.client.stream(method, path, headers=headers, **more) as response:  # type: ignore[arg-type]
            if "event-stream" not in response.headers.get("content-type", ""):
                response.read()
            return response


def routes() -> list[tuple[str, str]]:
    """(method, path) of everything the application offers."""
    with tempfile.TemporaryDirectory() as folder:
        app = create_app(Settings(data_dir=Path(folder)))
    included: list[Any] = [route for router in app.routes for route in router.effective_candidates()]  # type: ignore[attr-defined]
    found = [(method, route.path) for route in included for method in sorted(route.methods)]
    assert len(found) >= 20
    return found


ROUTES = routes()


def concrete(path: str, mesh: str = MISSING, job: str = MISSING, upload: str = MISSING, cohort: str = MISSING) -> str:
    """The path with its parameters filled in."""
    values = {
        "mesh_id": mesh,
        "job_id": job,
        "upload_id": upload,
        "cohort_id": cohort,
        "output": "report",
        "process_id": "validate",
    }
    return re.sub(r"\{(\w+)\}", lambda match: values[match[1]], path)


@contextmanager
def open_lab(settings: Settings) -> Iterator[Lab]:
    """Until the block ends."""
    with serving(settings) as live:
        db = live.services.db
        keys, workspaces = ApiKeys(db), Workspaces(db)
        a, b = workspaces.create("lab-a").id, workspaces.create("lab-b").id
        text = {role: keys.create(a, role, [scope]).text for role, scope in SCOPED.items()}
        text["owner"] = keys.create(a, "owner", Scope).text
        text["stranger"] = keys.create(b, "stranger", Scope).text
        revoked, expired = (keys.create(a, name, Scope, timedelta(days=1)) for name in ("revoked", "expired"))
        keys.revoke(revoked.key.id)
        with db.session() as session:
            past = db.now(session) - timedelta(seconds=1)
            session.execute(update(ApiKeyRow).where(ApiKeyRow.id == expired.key.id).values(expires_at=past))
        text |= {"nothing": "", "unknown": make_key_text().text, "mistyped": text["owner"][:-1] + "?"}
        text |= {"revoked": revoked.text, "expired": expired.text}
        made = Lab(live, text, "", "", "", "", "", a)
        sent = made.ask("POST", "/v1/meshes", "owner", files={"file": ("skin.stl", binary_stl())})
        assert sent.status_code == 201, sent.text
        upload = made.ask("POST", "/v1/uploads", "owner")
        assert upload.status_code == 201, upload.text
        job = live.successful(workspace=a)
        waiting = live.services.jobs.create(a, "validate", {})
        yield Lab(live, text, str(sent.json()["id"]), job.id, waiting.id, str(upload.json()["id"]), new_cohort(live, a), a)


def new_cohort(live: Live, workspace: WorkspaceId) -> str:
    """One whose only job has failed, so that everything but its summary can be asked of it."""
    subject = NewSubject("a", {}, (), UNKNOWN)
    cohort, [job] = live.services.cohorts.create(workspace, NewCohort("validate", {}, [subject]))
    taken = live.services.jobs.claim(job.id, 1, "tests", 60.0)
    assert taken is not None
    live.services.jobs.fail(job.id, taken.lease_token, JobFailure.of(InputError("skin.not_closed", "open")))
    return cohort.id
