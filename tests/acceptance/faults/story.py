"""What one request came to, as its client saw it."""

from __future__ import annotations

from dataclasses import dataclass, field

from tests.acceptance.faults.workload import Request


@dataclass
class Story:
    """Filled in by the one thread that tells it. `sha256` are of the outputs as they were downloaded."""

    request: Request
    job: str = ""
    dismissed: bool = False
    status: str = ""
    code: str = ""
    sha256: dict[str, str] = field(default_factory=dict)
    gaps: list[str] = field(default_factory=list)

    @property
    def is_accepted(self) -> bool:
        """A 201 was seen."""
        return bool(self.job)
