"""How many bytes all workspaces store together. Summing takes as long as there are files, so workers do it now and then."""

from __future__ import annotations

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from store.crew_records import MetricTotalRow
from store.database import Database
from store.records import JobRow, MeshRow
from store.tally import labels_text

STORED_BYTES = "integument_stored_bytes"
MEASURED_AT = "integument_stored_bytes_measured_timestamp_seconds"
SET = "set"  # the cell of a number that is replaced, not added to
FRESH_S = 300.0  # of many workers the next one leaves a younger sum alone


class StoredBytes:
    """Kept among the totals of `store.metrics`."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def measure(self, fresh_s: float = FRESH_S) -> bool:
        """Sum up again unless that was done lately; True if it was done now."""
        with self._db.reading() as session:
            now_s = self._db.now(session).timestamp()
            measured_at = session.scalars(select(MetricTotalRow.value).where(MetricTotalRow.family == MEASURED_AT)).one_or_none()
            if measured_at is not None and now_s - measured_at < fresh_s:
                return False
            uploads = session.execute(select(func.coalesce(func.sum(MeshRow.size_bytes), 0))).scalar_one()
            outputs = session.execute(select(func.coalesce(func.sum(JobRow.output_bytes), 0))).scalar_one()
        with self._db.session() as session:
            _put(session, STORED_BYTES, ("uploads",), float(uploads))
            _put(session, STORED_BYTES, ("outputs",), float(outputs))
            _put(session, MEASURED_AT, (), now_s)
        return True


def _put(session: Session, family: str, labels: tuple[str, ...], value: float) -> None:
    session.merge(MetricTotalRow(family=family, labels=labels_text(labels), cell=SET, value=value))
