"""How much load, in numbers: bounded, so a run stops by itself."""

from __future__ import annotations

from dataclasses import dataclass

MIB = 1024**2


@dataclass(frozen=True, slots=True)
class Size:
    """Counts and seconds of one run."""

    name: str
    accept_per_s: int
    accept_s: int
    clients: int
    jobs: int
    overhead_jobs: int
    scaling_jobs: int
    listeners: int
    watched_jobs: int
    silence_s: float
    upload_bytes: int
    uploads_at_once: int
    dismissed_at: tuple[int, ...]  # % of progress

    @property
    def accepted(self) -> int:
        """Requests of one accept run."""
        return self.accept_per_s * self.accept_s


FULL = Size("full", 100, 20, 50, 1000, 60, 40, 200, 20, 5.0, 1024 * MIB, 4, (0, 5, 20, 40, 60, 80, 95))
SMALL = Size("small", 20, 1, 2, 3, 1, 0, 6, 2, 0.5, 8 * MIB, 2, (0,))
