"""Attempts of a job that took down what worked on it: the evidence its owner may see."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field

from api.schemas.document import Document


class LostAttemptInfo(Document):
    """One attempt that ended in a crash or whose worker was lost."""

    attempt: int = Field(ge=1)
    worker: str = Field(description="Host and process")
    code: str = Field(description="`worker.lost`, `child.crashed` or `nursery.lost`")
    message: str
    signal: str | None = Field(None, description="That ended the work, such as `SIGSEGV`; unknown if the worker was lost")
    phase: str = Field(description="What it was at, as far as was told")
    progress: float = Field(ge=0, le=100)
    peak_memory_bytes: int | None = Field(None, alias="peakMemoryBytes")
    log: str = Field(description="The end of what the work printed; empty if the worker was lost")
    started: datetime | None = None
    ended: datetime


class LostAttemptList(Document):
    """Lost attempts of a job in their order; empty if none was."""

    attempts: tuple[LostAttemptInfo, ...]
