"""Writes down what people call a job: in its row to be shown, and where a search looks for it."""

from __future__ import annotations

from sqlalchemy import delete
from sqlalchemy.orm import Session

from store.job_words import JobWords, search_text
from store.records import JobLabelRow, JobRow


def label_job(row: JobRow, words: JobWords) -> None:
    """In its row. `index_labels` does the rest, once the row is in the database."""
    row.name, row.labels = words.name, list(words.labels) or None
    row.search_text = search_text(row.id, row.process, words, (mesh.name for mesh in row.mesh_inputs))


def index_labels(session: Session, row: JobRow) -> None:
    """Of a row that is in the database and has no labels there."""
    for label in row.labels or ():
        session.add(JobLabelRow(job_id=row.id, label=label, workspace=row.workspace, created_at=row.created_at))


def relabel_job(session: Session, row: JobRow, words: JobWords) -> None:
    """Of a locked row."""
    session.execute(delete(JobLabelRow).where(JobLabelRow.job_id == row.id))
    label_job(row, words)
    index_labels(session, row)
