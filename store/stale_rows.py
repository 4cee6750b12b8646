"""Rows nobody asks for any more: uploads that were given up, and what is old of idempotency keys, audit log, parked requests."""

from __future__ import annotations

from datetime import timedelta

from sqlalchemy import func, select

from store.audit import Audit
from store.database import Database
from store.idempotency import IdempotencyKeys
from store.parked import Parked
from store.records import AuditRow, IdempotencyRow, ParkedRow, UploadRow
from store.settings import Settings
from store.uploads import Uploads


class StaleRows:
    """What API and workers sweep by and by, counted and swept at once."""

    def __init__(self, db: Database, settings: Settings) -> None:
        self._db = db
        self._settings = settings

    def count(self) -> dict[str, int]:
        """By table."""
        with self._db.reading() as session:
            now = self._db.now(session)
            queries = {
                "uploads": UploadRow.expires_at < now,
                "idempotency_keys": IdempotencyRow.created_at < now - timedelta(hours=self._settings.idempotency_hours),
                "audit": AuditRow.at < now - timedelta(days=self._settings.audit_days),
                "parked": ParkedRow.parked_at < now - timedelta(days=self._settings.parked_days),
            }
            return {table: session.execute(select(func.count()).where(stale)).scalar_one() for table, stale in queries.items()}

    def sweep(self) -> dict[str, int]:
        """The same, forgotten."""
        return {
            "uploads": Uploads(self._db, self._settings.upload_hours).sweep(),
            "idempotency_keys": IdempotencyKeys(self._db, self._settings.idempotency_hours).sweep(),
            "audit": Audit(self._db).sweep(self._settings.audit_days),
            "parked": Parked(self._db).sweep(self._settings.parked_days),
        }
