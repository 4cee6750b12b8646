"""One step in the job's record: `steps.json`, an output beside report and package."""

from __future__ import annotations

from typing import Self

from pydantic import Field

from core.schema.model import FrozenModel
from core.schema.report import StepOutcome, StepReport


class StepRecord(FrozenModel):
    """What a step did in this attempt of the job, and how long it took."""

    name: str
    title: str
    outcome: StepOutcome = "not_reached"
    summary: str = ""
    numbers: dict[str, int | float | str] = {}
    seconds: float | None = Field(None, description="Wall time in this attempt; null if it was not taken")
    processor_s: float | None = Field(None, description="Processor time in this attempt, of all processes it started")
    taken_from_attempt_before: bool = Field(False, description="True: an attempt before had finished it; nothing was done again")
    faces_before: dict[str, int] = Field({}, description="Surface -> faces")
    faces_after: dict[str, int] = Field({}, description="Surface -> faces")

    @classmethod
    def of(cls, report: StepReport) -> Self:
        """Of a step that was not done."""
        return cls(name=report.name, title=report.title, outcome=report.outcome, summary=report.summary)

    def done(self, report: StepReport, faces_after: dict[str, int]) -> Self:
        """The same, with what it did."""
        return self.model_copy(
            update={
                "outcome": report.outcome,
                "summary": report.summary,
                "numbers": report.numbers,
                "faces_after": faces_after,
            }
        )

    def line(self) -> str:
        """For the job's log."""
        taken = (
            "taken from the attempt before" if self.taken_from_attempt_before else f"{self.processor_s or 0:.1f} s of processor"
        )
        return f"step {self.name} done ({taken}): {self.summary}"


class StepRecords(FrozenModel):
    """The whole record, in the order of the steps."""

    steps: tuple[StepRecord, ...]
