"""Tell the workers that a job waits. The message is a hint: the job table is the truth, and who finds no job drops it."""

from __future__ import annotations

import logging

from celery import Celery
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
            self._app.send_task(
                TASK,
                kwargs={"job_id": job_id, "attempt": attempt},
                queue=queue_name(self._queue, queue),
                serializer="json",
                ignore_result=True,
            )
        except OperationalError as error:
            _log.warning("broker does not answer, job %s attempt %d is announced later: %s", job_id, attempt, error)
            return False
        return True

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
