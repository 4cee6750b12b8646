"""A cohort: one process on many subjects, and the summary that is made when the last of them has ended."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from core.schema.expectation import MB, Expectation
from core.schema.model import FrozenModel
from core.schema.reference import VolumeReference
from core.schema.report import Verdict

COHORT_SUMMARY = "cohort_summary"
"""What its job is called in the job table. No process anybody can ask for: the server queues it."""

SUMMARY_NEED = Expectation(memory_bytes=300 * MB, cpu_s=5.0)
"""Of a thousand reports; nearly all of it are the libraries every child has."""

SUBJECT_INPUTS = ("skin", "mesh", "meshes", "surface", "volume", "base")
"""Where the mesh of a subject goes if nobody says it: the first of these that a process has."""


def takes_volume(inputs: type[FrozenModel], name: str) -> bool:
    """True if the input is a label volume, not a mesh."""
    return inputs.model_fields[name].annotation is VolumeReference


def subject_input_of(inputs: type[FrozenModel]) -> str | None:
    """The input that takes the mesh of a subject; None if the process has none of these."""
    return next((name for name in SUBJECT_INPUTS if name in inputs.model_fields), None)


class EndedSubject(FrozenModel):
    """How the job of one subject ended; `report` is the link to the report it left. `refused`: it never had a job."""

    subject: str
    job: str | None = None
    status: Literal["successful", "failed", "dismissed", "refused"]
    verdict: Verdict | None = None
    code: str | None = None
    message: str | None = None
    report: str | None = None


class CohortSummaryInputs(FrozenModel):
    """All of them, in the order of the request."""

    process: str
    name: str | None = None
    subjects: tuple[EndedSubject, ...]


class Outlier(FrozenModel):
    """A number of one subject that lies far from those of the others."""

    subject: str
    column: str
    value: float
    median: float
    deviations: float = Field(description="Robust deviations from the median, negative below it")
    reason: str = Field(description="The same in words")


class ColumnSummary(FrozenModel):
    """One number over all subjects that have it."""

    count: int
    minimum: float
    median: float
    maximum: float
    spread: float = Field(description="Median absolute deviation times 1.4826: of normal numbers the standard deviation")


class SubjectRow(FrozenModel):
    """One line of the table."""

    subject: str
    job: str | None
    status: str
    verdict: str | None
    code: str | None
    message: str | None
    numbers: dict[str, float]


class CohortSummary(FrozenModel):
    """summary.json: the table, what is usual in it, and what is not."""

    process: str
    name: str | None
    subjects: int
    ready: int
    not_ready: int
    failed: int
    dismissed: int
    refused: int
    columns: dict[str, ColumnSummary]
    outliers: tuple[Outlier, ...]
    rows: tuple[SubjectRow, ...]
    methods: str
