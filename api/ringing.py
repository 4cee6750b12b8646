"""After the commit: tell the workers."""

from __future__ import annotations

from api.services import Services
from store.job import Job


def ring(services: Services, job: Job) -> None:
    """Announce an accepted job. If the broker does not listen the client need not know: the reconciler announces it later."""
    if services.doorbell.ring(job.id, job.attempt):
        services.jobs.mark_rung(job.id, job.attempt)
