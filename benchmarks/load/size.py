"""How much load, in numbers: bounded, so a run stops by itself."""

from __future__ import annotations

from dataclasses import dataclass, replace

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

    def part(self, share: float) -> Size:
        """Fewer of everything that is counted, on a machine that has not got the time; rates and stages stay."""

        def some(count: int) -> int:
            return max(1, round(share * count))

        return replace(
            self,
            name=f"{self.name}-{share:g}",
            accept_s=some(self.accept_s),
            clients=some(self.clients),
            jobs=some(self.jobs),
            overhead_jobs=some(self.overhead_jobs),
            scaling_jobs=some(self.scaling_jobs),
            listeners=some(self.listeners),
            watched_jobs=some(self.watched_jobs),
            upload_bytes=some(self.upload_bytes),
        )


FULL = Size("full", 100, 20, 50, 1000, 60, 40, 200, 20, 5.0, 1024 * MIB, 4, (0, 5, 20, 40, 60, 80, 95))
SMALL = Size("small", 20, 1, 2, 3, 1, 0, 6, 2, 0.5, 8 * MIB, 2, (0,))
