"""One claimed job in a thread of the worker: supervise, never raise."""

from __future__ import annotations

import logging
from collections.abc import Callable

from core.errors import IntegumentError, InternalError
from sandbox.log_lines import add_log_context, log_context
from store.job import Job, JobFailure
from store.telemetry import span
from worker.supervise import RETRIED_CODES, supervise
from worker.workshop import Workshop

logger = logging.getLogger(__name__)


def run_job(workshop: Workshop, job: Job, leave: Callable[[], None]) -> None:
    """Bring a claimed job to its end; `leave` is called when it computes no more.

    Nothing escapes from here: the thread has other jobs to do."""
    known = {"job_id": job.id, "attempt": job.attempt, "workspace": job.workspace, "worker": workshop.name}
    with log_context(**known), span(f"run {job.process}", parent=job.traceparent) as attempt:
        attempt.note(integument__process=job.process, **{f"integument__{name}": value for name, value in known.items()})
        add_log_context(**({} if attempt.trace_id is None else {"trace_id": attempt.trace_id}))
        logger.info("job %s: attempt %d of %s begins", job.id, job.attempt, job.process, extra={"event": "job_claimed"})
        try:
            supervise(workshop, job, leave)
        except BaseException as error:
            attempt.fail(type(error).__name__)
            if _may_pass(error):
                logger.warning("job %s: tried again, if it may be: %s", job.id, error)
            else:
                logger.exception("job %s: the worker stumbled", job.id)
            _give_up(workshop, job, error)


def _may_pass(error: BaseException) -> bool:
    """Foreseen, and another attempt may be spared it: a disk that is full before there is a folder for the job."""
    return isinstance(error, IntegumentError) and error.code in RETRIED_CODES


def _give_up(workshop: Workshop, job: Job, error: BaseException) -> None:
    """Fail the job in the table, or queue it again if that may help; if even that cannot be done, its lease runs out and the
    reconciler sees to it."""
    if not isinstance(error, IntegumentError):
        error = InternalError("worker.raised", f"the worker stopped at an error nobody foresaw: {type(error).__name__}")
    try:
        workshop.jobs.fail(job.id, job.lease_token, JobFailure.of(error), retry=_may_pass(error))
    except BaseException:
        logger.exception("job %s: its failure cannot be written down", job.id)
