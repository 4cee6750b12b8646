"""Which jobs an operator means."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta

from store.job import JobStatus
from store.workspace import WorkspaceId

FINISHED = tuple(status for status in JobStatus if status.is_finished)


@dataclass(frozen=True, slots=True)
class JobSelector:
    """What is empty or None selects nothing away; several of a kind mean any of them.

    `older_than`: that long since the job ended, or since it was accepted if it has not ended. `code`: of its failure."""

    statuses: tuple[JobStatus, ...] = ()
    workspaces: tuple[WorkspaceId, ...] = ()
    processes: tuple[str, ...] = ()
    code: str | None = None
    older_than: timedelta | None = None

    @property
    def is_everything(self) -> bool:
        """Whether nothing narrows it down; the status does not count, commands set it themselves."""
        return not (self.workspaces or self.processes or self.code or self.older_than)
