"""The Celery application: a doorbell's other end. Which job runs, and whether, is decided in the job table."""

from __future__ import annotations

from celery import Celery
from kombu import Queue

from store.doorbell import TASK
from worker.task import run_job
from worker.transport import install
from worker.workshop import Workshop

DAY_S = 86_400


def create_app(workshop: Workshop) -> Celery:
    """One task, `jobs.run(job_id, attempt)`, JSON only."""
    install()
    settings = workshop.settings
    app = Celery("integument", broker=settings.broker_url, set_as_current=False)
    app.conf.update(
        accept_content=["json"],
        task_serializer="json",
        result_serializer="json",
        task_ignore_result=True,
        task_store_errors_even_if_ignored=False,
        task_queues=[Queue(settings.queue)],
        task_default_queue=settings.queue,
        # a message is spent once taken: duplicates and losses are mended from the job table, never by the broker
        task_acks_late=False,
        task_reject_on_worker_lost=False,
        worker_prefetch_multiplier=1,
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

    @app.task(name=TASK, ignore_result=True)
    def run(job_id: str, attempt: int) -> None:
        run_job(workshop, job_id, attempt)

    return app
