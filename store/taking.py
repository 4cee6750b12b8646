"""The one way from accepted to running."""

from __future__ import annotations

from datetime import datetime, timedelta

from sqlalchemy import bindparam, update
from sqlalchemy.orm import Session

from store.announcement import announce
from store.job import JobStatus
from store.job_tally import count_attempt
from store.outbox import tell_subscriber
from store.records import JobRow


def take(session: Session, job_id: str, attempt: int, worker: str, lease_s: float, now: datetime) -> JobRow | None:
    """Give an attempt of an accepted job to a worker; None if it is taken, gone, or waits for another attempt.

    One conditional UPDATE decides, so of any number of callers one wins. Every later write names the row's `lease_token`."""
    wanted = {"of": job_id, "of_attempt": attempt, "owner": worker, "until": now + timedelta(seconds=lease_s), "now": now}
    row = session.scalars(_TAKE, {**wanted, "said": f"attempt {attempt} started"}).one_or_none()
    if row is not None:
        announce(session, row, now)
        tell_subscriber(session, row, now)
        count_attempt(session, row, now)
    return row


_TAKE = (
    update(JobRow)
    .where(JobRow.id == bindparam("of"), JobRow.attempt == bindparam("of_attempt"), JobRow.status == JobStatus.ACCEPTED)
    .values(
        status=JobStatus.RUNNING,
        lease_owner=bindparam("owner"),
        lease_token=JobRow.lease_token + 1,
        lease_until=bindparam("until"),
        started_at=bindparam("now"),
        phase="start",
        progress=0.0,
        message=bindparam("said"),
    )
    .returning(JobRow)
    .execution_options(synchronize_session=False, populate_existing=True)
)
