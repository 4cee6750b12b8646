"""What servers of the version before this one say to the tables, word for word: it is still said during an upgrade.

Written down from revision v0006, the last one without expectations; nothing here may follow a change of the sources."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from uuid import uuid4

from sqlalchemy import text

from store.database import Database

REVISION = "v0006"

ACCEPT = text(
    "INSERT INTO jobs (id, workspace, process, inputs, status, phase, progress, message, attempt, max_attempts, lease_token, "
    "dismiss_requested, created_at, queued_at, updated_at, timings_s, event_seq, output_bytes) VALUES (:id, 'default', "
    "'validate', :inputs, 'accepted', '', 0.0, 'waits for a worker', 1, 2, 0, :no, :now, :now, :now, '{}', 1, 0)"
)
TELL = text("INSERT INTO job_events (job_id, seq, type, data, at) VALUES (:id, 1, 'status', :data, :now)")
CLAIM = text(
    "UPDATE jobs SET status = 'running', phase = 'start', progress = 0.0, message = 'attempt 1 started', lease_owner = :worker, "
    "lease_token = lease_token + 1, lease_until = :until, started_at = :now WHERE id = :id AND attempt = 1 "
    "AND status = 'accepted' RETURNING lease_token"
)
FINISH = text(
    "UPDATE jobs SET status = 'successful', verdict = 'not_ready', summary = '', progress = 100.0, finished_at = :now, "
    "lease_owner = NULL, lease_until = NULL WHERE id = :id AND lease_token = :token AND status = 'running' RETURNING id"
)
STATUS = text("SELECT status FROM jobs WHERE id = :id")


class EarlierVersion:
    """An API and a worker of that version, as far as the job table sees them."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def accept(self, **inputs: object) -> str:
        job_id = str(uuid4())
        values = {"id": job_id, "inputs": json.dumps(inputs), "no": False, "now": self._now()}
        with self._db.session() as session:
            session.execute(ACCEPT, values)
            session.execute(TELL, {"id": job_id, "data": json.dumps({"status": "accepted"}), "now": self._now()})
        return job_id

    def claim(self, job_id: str, until: datetime) -> int | None:
        with self._db.session() as session:
            values = {"id": job_id, "worker": "old-host:7", "now": self._now(), "until": self._instant(until)}
            token: int | None = session.execute(CLAIM, values).scalar_one_or_none()
            return token

    def finish(self, job_id: str, token: int) -> bool:
        with self._db.session() as session:
            done = session.execute(FINISH, {"id": job_id, "token": token, "now": self._now()})
            return done.scalar_one_or_none() is not None

    def status(self, job_id: str) -> str:
        with self._db.reading() as session:
            return str(session.execute(STATUS, {"id": job_id}).scalar_one())

    def _now(self) -> object:
        return self._instant(datetime.now(UTC))

    def _instant(self, moment: datetime) -> object:
        return moment.replace(tzinfo=None).isoformat(" ", "microseconds") if self._db.is_sqlite else moment
