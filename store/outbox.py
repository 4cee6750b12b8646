"""Callbacks are written down in the very transaction that changes the job: there is never one without the other."""

from __future__ import annotations

from datetime import datetime
from uuid import uuid4

from sqlalchemy import delete
from sqlalchemy.orm import Session

from store.callback import CallbackEvent, CallbackState, Subscriber
from store.job import JobStatus
from store.records import CallbackRow, JobRow
from store.status_info import status_info

EVENTS = {
    JobStatus.RUNNING: CallbackEvent.IN_PROGRESS,
    JobStatus.SUCCESSFUL: CallbackEvent.SUCCESS,
    JobStatus.FAILED: CallbackEvent.FAILED,
    JobStatus.DISMISSED: CallbackEvent.DISMISSED,
}


def tell_subscriber(session: Session, row: JobRow, now: datetime) -> None:
    """Write down what is to be sent now that the job has this status."""
    event = EVENTS.get(JobStatus(row.status))
    if row.subscriber is None or event is None:
        return
    if event is not CallbackEvent.IN_PROGRESS:
        _forget_progress(session, row)
    subscriber = Subscriber.read(row.subscriber)
    uri = subscriber.uri_of(event)
    if uri is None:
        return
    session.add(
        CallbackRow(
            id=str(uuid4()),
            workspace=row.workspace,
            job_id=row.id,
            event=event,
            uri=uri,
            body=status_info(row, subscriber.base_url),
            state=CallbackState.PENDING,
            attempts=0,
            lease_token=0,
            created_at=now,
            due_at=now,
        )
    )


def _forget_progress(session: Session, row: JobRow) -> None:
    """That it started was tried in vain; hours after its end nobody should hear of it."""
    session.execute(
        delete(CallbackRow).where(
            CallbackRow.job_id == row.id,
            CallbackRow.event == CallbackEvent.IN_PROGRESS,
            CallbackRow.state == CallbackState.PENDING,
            CallbackRow.attempts > 0,
        )
    )
