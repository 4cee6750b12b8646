"""Jobs for people."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime

from rich import box
from rich.table import Table
from rich.text import Text

from integument.job import Job

STYLES = {"accepted": "dim", "running": "cyan", "successful": "green", "failed": "red", "dismissed": "dim"}


def job_table(jobs: Iterable[Job]) -> Table:
    """A row per job."""
    table = Table(box=box.SIMPLE_HEAD)
    for title in ("job", "process", "status", "verdict", "created"):
        table.add_column(title, no_wrap=True)
    table.add_column("message", overflow="ellipsis", no_wrap=True)
    for job in jobs:
        status = f"{job.status} {job.progress:.0f} %" if job.status == "running" else job.status
        said = job.failure.code if job.failure else job.message or ""
        table.add_row(job.id, job.process, Text(status, STYLES[job.status]), job.verdict or "", _local(job.created), Text(said))
    return table


def job_lines(job: Job) -> list[str]:
    """Everything of one job, a line each; what is not known is left out."""
    failure = None if job.failure is None else f"{job.failure.code} ({job.failure.fault}): {job.failure.message}"
    facts = {
        "job": job.id,
        "process": job.process,
        "name": job.name,
        "labels": ", ".join(job.labels),
        "cohort": job.cohort_id,
        "subject": job.subject,
        "status": job.status,
        "progress": f"{job.progress:.0f} %",
        "phase": job.phase,
        "message": job.message,
        "queue position": job.queue_position,
        "attempt": job.attempt,
        "created": _local(job.created),
        "started": _local(job.started),
        "finished": _local(job.finished),
        "seconds": None if job.seconds is None else f"{job.seconds:.1f}",
        "verdict": job.verdict,
        "summary": job.summary,
        "failure": failure,
        "left": ", ".join(job.left),
    }
    return [f"{name:<15} {value}" for name, value in facts.items() if value not in (None, "")]


def _local(moment: datetime | None) -> str:
    return "" if moment is None else moment.astimezone().strftime("%Y-%m-%d %H:%M:%S")
