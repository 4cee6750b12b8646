"""Cohorts: one request for many subjects, and how it goes with them."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import Field

from api.schemas.document import Document
from api.schemas.execution import SubscriberRequest
from api.schemas.job_words import Labels, Name
from api.schemas.link import Link
from core.schema.reference import MeshReference

InputName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,63}$")]


class SubjectRequest(Document):
    """One subject."""

    name: Name | None = Field(None, description="What its line in the summary is called; the name of its mesh without one")
    mesh: MeshReference | None = Field(None, description="Goes where `subjectInput` says")
    inputs: dict[str, Any] = Field({}, description="Its own, in place of those of the same name that all share")


class CohortSettings(Document):
    """What all subjects share."""

    process: str = Field(max_length=64, description="Id of a process, see GET /v1/processes")
    inputs: dict[str, Any] = Field({}, description="For every subject")
    subject_input: InputName | None = Field(
        None,
        alias="subjectInput",
        description="Which input takes a subject's mesh; without it the first the process has of skin, mesh, meshes, surface, "
        "volume, base",
    )
    name: Name | None = Field(None, description="What people call the cohort")
    labels: Labels = Field((), description="Of the cohort and of every job of it")
    subscriber: SubscriberRequest | None = Field(
        None, description="Called back about the summary, so when all subjects have ended"
    )


class CohortRequest(CohortSettings):
    """A process on many subjects. Accepted whole or not at all."""

    subjects: Annotated[tuple[SubjectRequest, ...], Field(min_length=1)]


class ArchivedSubject(Document):
    """Inputs of its own for one file of an archive."""

    name: Name = Field(description="Of the file, without folders and suffix")
    inputs: dict[str, Any]


class ArchiveSettings(CohortSettings):
    """What goes with an archive: the field `cohort` of a form."""

    subjects: tuple[ArchivedSubject, ...] = Field((), description="Only those that have inputs of their own")


class CohortFromUpload(ArchiveSettings):
    """A finished upload that is an archive."""

    unit: str | None = Field(None, description="m, cm, mm or in; left out as `Upload-Metadata` said")


class Counts(Document):
    """Jobs by status; `refused` never had one."""

    accepted: int = 0
    running: int = 0
    successful: int = 0
    failed: int = 0
    dismissed: int = 0
    refused: int = 0


class Refusal(Document):
    """A subject whose file could not be read."""

    subject: str
    code: str = Field(description="Stable code, see docs/errors.md")
    message: str


class CohortInfo(Document):
    """How a cohort stands."""

    id: str
    process_id: str = Field(alias="processID")
    name: str | None = None
    labels: tuple[str, ...] = ()
    status: Literal["running", "summarizing", "finished"] = Field(
        description="`summarizing`: all subjects have ended; `finished`: the summary has, too"
    )
    progress: int = Field(ge=0, le=100, description="Mean over the jobs, in percent")
    subjects: int
    counts: Counts
    ready: int = Field(description="Successful jobs with the verdict simulation_ready")
    refused: tuple[Refusal, ...] = ()
    round: int = Field(description="Counts the retries, from 1")
    inputs: dict[str, Any] = Field(description="What all subjects share")
    created: datetime
    finished: datetime | None = Field(None, description="When the last job ended")
    summary_job: str | None = Field(None, alias="summaryJob", description="The job that makes, or made, the summary")
    links: tuple[Link, ...]


class CohortList(Document):
    """A page of cohorts, newest first."""

    cohorts: tuple[CohortInfo, ...]
    next: str | None = Field(None, description="Cursor of the next page; absent on the last")
    links: tuple[Link, ...]
