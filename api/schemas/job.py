"""Jobs as OGC describes them (statusInfo, jobList, results), with what this server adds."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import ConfigDict, Field, RootModel

from api.schemas.document import Document
from api.schemas.link import Link
from core.errors import Fact
from core.schema.report import Verdict

JobStatus = Literal["accepted", "running", "successful", "failed", "dismissed"]


class Failure(Document):
    """Why a job failed, and whose fault it was."""

    code: str = Field(description="Stable code, see docs/errors.md")
    fault: Literal["input", "limit", "state", "internal"] = Field(
        alias="class", description="Whose fault: `input` (change it), `limit`, `internal` (ours)"
    )
    message: str
    retryable: bool = Field(description="True if the same job may succeed when it is run again")
    facts: dict[str, Fact] = {}


class StatusInfo(Document):
    """The state of a job."""

    type: Literal["process"] = "process"
    job_id: str = Field(alias="jobID")
    process_id: str = Field(alias="processID")
    name: str | None = Field(None, description="What people call the job")
    labels: tuple[str, ...] = Field((), description="To find it by")
    cohort_id: str | None = Field(None, alias="cohortID", description="The cohort it belongs to")
    subject: str | None = Field(None, description="Which subject of that cohort it works on")
    status: JobStatus
    message: str = Field(description="What is being done, or how it ended, for people")
    progress: int = Field(ge=0, le=100, description="Percent of the whole job")
    created: datetime
    started: datetime | None = None
    finished: datetime | None = None
    updated: datetime
    expires: datetime | None = Field(None, description="When the job is removed with its results; absent: never")
    phase: str | None = Field(None, description="The step being worked on, `shells: fat`")
    queue_position: int | None = Field(None, alias="queuePosition", description="1: next in line; only while accepted")
    attempt: int = Field(ge=1, description="Counts the runs, automatic and asked for")
    verdict: Verdict | None = Field(None, description="Of a successful job")
    summary: str | None = Field(None, description="The result in a sentence")
    failure: Failure | None = Field(None, description="Of a failed job")
    timings_s: dict[str, float] | None = Field(None, description="Seconds per phase, once the job ended")
    peak_memory_bytes: int | None = Field(None, alias="peakMemoryBytes")
    queue: Literal["fast", "heavy"] = Field(description="Jobs of seconds wait apart from jobs of minutes")
    expected_memory_bytes: int = Field(alias="expectedMemoryBytes", description="A worker takes the job when so much is free")
    expected_cpu_s: float | None = Field(
        None, alias="expectedCpuSeconds", description="Processor time one attempt may take, roughly"
    )
    links: tuple[Link, ...] = Field(description="Of a failed job those with the relation `item` lead to what it left")


class JobList(Document):
    """A page of jobs, newest first."""

    jobs: tuple[StatusInfo, ...]
    next: str | None = Field(None, description="Cursor of the next page; absent on the last")
    links: tuple[Link, ...]


class ResultReference(Document):
    """One output, by reference."""

    href: str = Field(description="Absolute URL; its path is also an input reference for the next job")
    type: str = Field(description="Media type")
    title: str = Field(description="File name")


class Results(RootModel[dict[str, ResultReference]]):
    """Name of output -> where to get it."""

    model_config = ConfigDict(frozen=True)
