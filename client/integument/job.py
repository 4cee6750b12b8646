"""Jobs: the OGC statusInfo document with what this server adds to it."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import Field

from integument.answer import Answer
from integument.result import Output

Status = Literal["accepted", "running", "successful", "failed", "dismissed"]
FINISHED: frozenset[str] = frozenset({"successful", "failed", "dismissed"})
READY = "simulation_ready"
ITEM = "item"  # the relation of links to what a failed job left


class Failure(Answer):
    """Why a job failed. `fault`: input, limit, state or internal."""

    code: str
    fault: str = Field("internal", alias="class")
    message: str = ""
    retryable: bool = False
    facts: dict[str, Any] = {}


class Job(Answer):
    """One request to a process and what became of it."""

    id: str = Field(alias="jobID")
    process: str = Field("", alias="processID")
    name: str | None = None
    labels: tuple[str, ...] = ()
    cohort_id: str | None = Field(None, alias="cohortID")
    subject: str | None = Field(None, description="Of that cohort")
    status: Status
    progress: float = 0.0
    phase: str | None = None
    message: str | None = None
    created: datetime | None = None
    started: datetime | None = None
    finished: datetime | None = None
    queue_position: int | None = Field(None, alias="queuePosition")
    attempt: int = 1
    verdict: str | None = Field(None, description="`simulation_ready` or `not_ready`; null until successful")
    summary: str | None = None
    failure: Failure | None = None
    timings_s: dict[str, float] | None = Field(None, description="Seconds per phase, when finished")
    links: tuple[Output, ...] = ()

    @property
    def done(self) -> bool:
        """Nothing more will happen to it, unless somebody retries it."""
        return self.status in FINISHED

    @property
    def ready(self) -> bool:
        """Successful, and what it made or looked at is fit for simulation."""
        return self.status == "successful" and self.verdict == READY

    @property
    def left(self) -> dict[str, Output]:
        """What a failed job left all the same, by name: its report, and of `prepare` the surfaces as the last finished step left
        them and the record of the steps. `Client.download` fetches them, and the next job may take them as inputs."""
        return {link.href.rpartition("/")[2]: link for link in self.links if link.rel == ITEM}

    @property
    def seconds(self) -> float | None:
        """From start to end, if both are known."""
        if self.started is None or self.finished is None:
            return None
        return (self.finished - self.started).total_seconds()
