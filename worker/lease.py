"""One attempt's hold on its job: renewed every heartbeat, and with it goes what the child has said."""

from __future__ import annotations

import logging
import time

from core.errors import IntegumentError
from store.job import Job
from worker.outage import is_outage, sit_out
from worker.progress import Progress
from worker.workshop import Workshop

logger = logging.getLogger(__name__)

NEWS_S = 0.5  # a client sees progress at most this late


class LeaseLostError(Exception):
    """The job belongs to somebody else now, or is gone: nothing may be written any more."""


class DismissedError(Exception):
    """The user took the job back."""


class ToldToStopError(Exception):
    """The worker stops, and its patience with running jobs is over."""


class Lease:
    """`beat` as often as you like; it knows when a heartbeat is due."""

    def __init__(self, workshop: Workshop, job: Job, progress: Progress) -> None:
        self._workshop = workshop
        self._job = job
        self._progress = progress
        self._tried_at = time.monotonic()  # the claim
        self.peak_bytes = 0  # of the child's memory, as far as anybody looked

    def beat(self) -> None:
        """Renew if due. Raises LeaseLostError, DismissedError, ToldToStopError: end the child and leave.

        A database that is away is no reason to end the child: every write is fenced, so whoever took over is safe from us."""
        if self._workshop.closing.is_over:
            raise ToldToStopError
        silent_s = time.monotonic() - self._tried_at
        if silent_s >= self._workshop.settings.heartbeat_s or (silent_s >= NEWS_S and self._progress.news()):
            try:
                self._renew()
            except IntegumentError as error:
                if not is_outage(error):
                    raise
                logger.warning("job %s: cannot renew the lease now: %s", self._job.id, error)

    def tell_all(self) -> None:
        """Everything the child said is in the job table after this. Raises LeaseLostError, DismissedError."""
        sit_out(self._renew)

    def _renew(self) -> None:
        self._tried_at = time.monotonic()
        news = self._progress.news()
        renewal = self._workshop.jobs.renew(
            self._job.id,
            self._job.lease_token,
            self._workshop.settings.lease_s,
            progress=news.progress,
            phase=news.phase,
            message=news.message,
            events=news.events,
            peak_memory_bytes=self.peak_bytes or None,
        )
        self._progress.told(news)
        if not renewal.kept:
            raise LeaseLostError
        if renewal.dismiss_requested:
            raise DismissedError
