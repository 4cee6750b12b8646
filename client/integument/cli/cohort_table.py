"""Cohorts for people."""

from __future__ import annotations

from collections.abc import Iterable

from rich import box
from rich.table import Table
from rich.text import Text

from integument.cli.job_table import STYLES
from integument.cohort import Cohort, Refusal
from integument.job import Job


def cohort_table(cohorts: Iterable[Cohort]) -> Table:
    """A row per cohort."""
    table = Table(box=box.SIMPLE_HEAD)
    for title in ("cohort", "process", "status", "subjects", "ready", "failed"):
        table.add_column(title, no_wrap=True)
    table.add_column("name", overflow="ellipsis", no_wrap=True)
    for cohort in cohorts:
        status = f"{cohort.status} {cohort.progress:.0f} %" if not cohort.done else cohort.status
        bad = cohort.counts.failed + cohort.counts.refused
        table.add_row(
            cohort.id, cohort.process, status, str(cohort.subjects), str(cohort.ready), str(bad), Text(cohort.name or "")
        )
    return table


def subject_table(jobs: Iterable[Job], refused: Iterable[Refusal]) -> Table:
    """A row per subject."""
    table = Table(box=box.SIMPLE_HEAD)
    for title, width in (("subject", 7), ("status", 10), ("verdict", 16), ("job", 36)):
        table.add_column(title, no_wrap=True, min_width=width)  # a long message would squeeze them
    table.add_column("message", overflow="ellipsis", no_wrap=True)
    for job in jobs:
        said = job.failure.code if job.failure else job.summary or job.message or ""
        status = Text(job.status, STYLES[job.status])
        table.add_row(Text(job.subject or ""), status, job.verdict or "", job.id, Text(said))
    for one in refused:
        table.add_row(Text(one.subject), Text("refused", STYLES["failed"]), "", "", Text(one.code))
    return table
