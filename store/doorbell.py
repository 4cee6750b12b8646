"""Tell the workers that a job waits. The message is a hint: the job table is the truth, and who finds no job drops it."""

from __future__ import annotations

import logging
from collections.abc import Iterable

from celery import Celery, Signature, group
from kombu.exceptions import OperationalError

from core.schema.expectation import JobQueue

TASK = "jobs.run"
PUBLISH_S = 1.0

_log = logging.getLogger(__name__)


def queue_name(base: str, queue: JobQueue | None = None) -> str:
    """The broker's name of a queue of jobs; without one, of that which every worker hears."""
    return base if queue is None else f"{base}.{queue.value}"


class Doorbell:
    """Sends the id and attempt of a job, nothing else. Thread-safe; connects when first rung.

    The message is no order to run that very job: whoever hears it looks whose turn it is. `jobs.fast` and `jobs.heavy` are heard
    by the workers of these queues, `jobs` by all: there the reconciler rings, and servers of the version before."""

    def __init__(self, broker_url: str, queue: str = "jobs") -> None:
        self._queue = queue
        self._app = Celery("integument.doorbell", broker=broker_url, set_as_current=False)
        self._app.conf.update(
            task_serializer="json",
            task_ignore_result=True,
            task_publish_retry=False,
            broker_transport_options={"socket_timeout": PUBLISH_S, "socket_connect_timeout": PUBLISH_S, "max_retries": 0},
        )

    def ring(self, job_id: str, attempt: int, queue: JobQueue | None = None) -> bool:
        """To the workers of `queue`, or to all.

        False if the broker did not take the message within about a second; the reconciler rings again later."""
        try:
            self._signature(job_id, attempt, queue).apply_async()
        except OperationalError as error:
            _log.warning("broker does not answer, job %s attempt %d is announced later: %s", job_id, attempt, error)
            return False
        return True

    def ring_all(self, cohort_id: str, bells: Iterable[tuple[str, int, JobQueue]]) -> bool:
        """For a whole cohort: one Celery group whose id is the cohort's, with a bell for each (job id, attempt, queue).

        Nothing waits for the group's end: the job table knows it. False as in `ring`; some may have been rung then."""
        canvas = group([self._signature(*bell) for bell in bells], app=self._app)
        try:
            canvas.apply_async(task_id=cohort_id, add_to_parent=False)
        except OperationalError as error:
            _log.warning("broker does not answer, the jobs of cohort %s are announced later: %s", cohort_id, error)
            return False
        return True

    def _signature(self, job_id: str, attempt: int, queue: JobQueue | None) -> Signature:
        told = {"job_id": job_id, "attempt": attempt}
        return self._app.signature(TASK, kwargs=told, queue=queue_name(self._queue, queue), serializer="json", ignore_result=True)

    def is_answered(self) -> bool:
        """True if a broker of the right kind takes connections; a hanging one is told within about two seconds."""
        with self._app.connection_for_write() as connection:
            try:
                connection.default_channel.client.ping()
            except (OperationalError, *connection.connection_errors, *connection.channel_errors) as error:
                _log.warning("broker does not answer: %s", error)
                return False
        return True

    def close(self) -> None:
        """Close the connections."""
        self._app.close()
