"""The Celery application: a doorbell's other end. Which job runs, and whether, is decided in the job table."""

from __future__ import annotations

from celery import Celery, bootsteps
from kombu import Exchange, Queue

from store.doorbell import TASK, queue_name
from store.settings import Settings
from worker.crew import Crew
from worker.transport import install
from worker.workshop import Workshop

DAY_S = 86_400


def heard_queues(settings: Settings) -> list[str]:
    """The broker's names of the queues a worker listens to."""
    return [queue_name(settings.queue), *(queue_name(settings.queue, queue) for queue in settings.worker_queues)]


def create_app(workshop: Workshop, crew: Crew) -> Celery:
    """One task, `jobs.run(job_id, attempt)`, JSON only; what it says is not looked at."""
    install()
    settings = workshop.settings
    app = Celery("integument", broker=settings.broker_url, set_as_current=False)
    app.conf.update(
        accept_content=["json"],
        task_serializer="json",
        result_serializer="json",
        task_ignore_result=True,
        task_store_errors_even_if_ignored=False,
        task_queues=[Queue(name, Exchange(name), routing_key=name) for name in heard_queues(settings)],
        task_default_queue=settings.queue,
        # a message is spent once taken: duplicates and losses are mended from the job table, never by the broker
        task_acks_late=False,
        task_reject_on_worker_lost=False,
        # one bell at a time, by the number of tasks under way; not by unacknowledged messages (0): broken ones leave some behind
        worker_prefetch_multiplier=0,
        worker_disable_prefetch=True,
        worker_cancel_long_running_tasks_on_connection_loss=False,
        broker_connection_retry_on_startup=True,
        broker_connection_max_retries=None,
        broker_transport_options={
            "visibility_timeout": DAY_S,
            "socket_timeout": 30,  # above the 1 s a blocking pop may take
            "socket_connect_timeout": 5,
            "socket_keepalive": True,
        },
        worker_send_task_events=False,
        worker_enable_remote_control=False,
        worker_hijack_root_logger=False,
        worker_redirect_stdouts=False,
    )

    class CrewStep(bootsteps.StartStopStep):  # type: ignore[misc]  # Celery has no types
        """From now on a signal to stop is heard, so jobs may be taken; a broker that is away keeps nobody from that."""

        requires = ("celery.worker.components:Pool",)

        def start(self, parent: object) -> None:
            crew.start()

    app.steps["worker"].add(CrewStep)

    @app.task(name=TASK, ignore_result=True)
    def run(job_id: object = None, attempt: object = None) -> None:
        crew.ring()

    return app
