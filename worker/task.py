"""The body of the Celery task: claim, supervise, never raise."""

from __future__ import annotations

import logging

from core.errors import IntegumentError, InternalError
from store.job import Job, JobFailure
from worker.supervise import supervise
from worker.workshop import Workshop

logger = logging.getLogger(__name__)


def run_job(workshop: Workshop, job_id: str, attempt: int) -> None:
    """Safe to deliver twice: `claim` hands an attempt of a job to one caller only.

    Nothing escapes from here: Celery takes a MemoryError for its own end, and a SystemExit as well."""
    if workshop.closing.has_begun:
        workshop.closing.left.append((job_id, attempt))
        return
    try:
        job = workshop.jobs.claim(job_id, attempt, workshop.name, workshop.settings.lease_s)
        if job is None:
            logger.debug("job %s attempt %d is not to be had", job_id, attempt)
            return
    except BaseException:
        logger.exception("job %s: cannot be claimed; it is announced again later", job_id)
        return
    try:
        supervise(workshop, job)
    except BaseException as error:
        logger.exception("job %s: the worker stumbled", job_id)
        _give_up(workshop, job, error)


def _give_up(workshop: Workshop, job: Job, error: BaseException) -> None:
    """Fail the job in the table; if even that cannot be done, its lease runs out and the reconciler sees to it."""
    if not isinstance(error, IntegumentError):
        error = InternalError("worker.raised", f"the worker stopped at an error nobody foresaw: {type(error).__name__}")
    try:
        workshop.jobs.fail(job.id, job.lease_token, JobFailure.of(error))
    except BaseException:
        logger.exception("job %s: its failure cannot be written down", job.id)
