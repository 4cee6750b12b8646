"""Cohorts: one process on many subjects."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import Field

from integument.answer import Answer


class Counts(Answer):
    """Jobs by status; `refused` never had one."""

    accepted: int = 0
    running: int = 0
    successful: int = 0
    failed: int = 0
    dismissed: int = 0
    refused: int = 0


class Refusal(Answer):
    """A subject whose file could not be read."""

    subject: str
    code: str = ""
    message: str = ""


class Cohort(Answer):
    """How it goes with all subjects."""

    id: str
    process: str = Field("", alias="processID")
    name: str | None = None
    labels: tuple[str, ...] = ()
    status: Literal["running", "summarizing", "finished"]
    progress: float = 0.0
    subjects: int = 0
    counts: Counts = Counts()
    ready: int = 0
    refused: tuple[Refusal, ...] = ()
    round: int = 1
    created: datetime | None = None
    summary_job: str | None = Field(None, alias="summaryJob")

    @property
    def done(self) -> bool:
        """All subjects have ended, and the summary has, too."""
        return self.status == "finished"

    @property
    def all_ready(self) -> bool:
        """Every subject is fit for simulation."""
        return self.done and self.ready == self.subjects
