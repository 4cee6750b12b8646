"""What happens to a job while somebody watches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class JobEvent:
    """One line of a job's diary. `type`: status, progress, log, and last of all done."""

    id: str
    type: str
    data: dict[str, Any]

    @property
    def progress(self) -> float | None:
        """Percent of the whole job, if this event says."""
        value = self.data.get("progress")
        return float(value) if isinstance(value, int | float) else None

    @property
    def phase(self) -> str:
        """The step the job is in; empty if this event does not say."""
        return str(self.data.get("phase") or "")

    @property
    def message(self) -> str:
        """For people."""
        return str(self.data.get("message") or "")
