"""A whole worker process, from start to clean end."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any

from celery.apps import worker as celery_worker
from celery.signals import worker_ready, worker_shutting_down

from core.errors import IntegumentError
from sandbox.frozen_heap import freeze_heap
from store.checkpointer import Checkpointer
from store.metrics import Metrics
from store.periodic import Periodic
from store.receivers import Receivers
from store.schema_check import require_own_schema
from store.settings import Settings
from store.stored_bytes import StoredBytes
from worker.app import create_app, heard_queues
from worker.callback_sender import CallbackSender
from worker.crew import Crew
from worker.deliverer import Deliverer
from worker.liveness import Liveness
from worker.outage import is_outage
from worker.pool import BellTaskPool
from worker.presence import Presence
from worker.reconciler import SWEEP_S, Reconciler
from worker.workshop import TARGET, Workshop

logger = logging.getLogger(__name__)


def run_worker(settings: Settings, *, target: str = TARGET, preload: Sequence[str] | None = None) -> int:
    """Work until SIGTERM or SIGINT; returns the exit code. For the main thread only.

    On the signal no job is claimed any more; those that run have `drain_s` to end, then they are handed back to the queue.
    A worker whose tables are of another version does not begin: exit code 2. One that runs while they are migrated goes on."""
    workshop = Workshop.open(settings, target=target, preload=preload)
    try:
        require_own_schema(workshop.db)
    except IntegumentError as error:
        if not is_outage(error):  # a database that is away is waited for
            logger.error("%s [%s]", error.message, error.code)
            workshop.close()
            return 2
    workshop.nursery.start()  # before Celery has any thread
    liveness = Liveness(settings)
    reconciler = Reconciler(workshop, liveness)
    sender = CallbackSender(Receivers(settings.callback_allow), settings.callback_secret)
    deliverer = Deliverer(workshop.callbacks, sender)
    presence = Presence(workshop)
    crew = Crew(workshop)
    checkpointer = Checkpointer(workshop.db)
    rounds = (
        Periodic("presence", presence.beat, settings.reconcile_s),
        Periodic("metrics", Metrics(workshop.db).fold, settings.reconcile_s),
        Periodic("stored bytes", StoredBytes(workshop.db).measure, SWEEP_S),
    )

    def on_ready(**_: Any) -> None:
        reconciler.start()
        checkpointer.start()
        for one in rounds:
            one.start()
        if settings.callback_secret:  # else the API takes no subscribers
            deliverer.start()
        freeze_heap()
        logger.info("worker %s is ready, %d jobs at a time", workshop.name, settings.worker_concurrency)

    def on_stop(**_: Any) -> None:
        workshop.closing.begin()  # the crew sees it
        reconciler.let_go()
        deliverer.let_go()

    celery_worker.safe_say = lambda *_, **__: None  # what it prints at its end is no line of a log
    worker_ready.connect(on_ready, weak=False)
    worker_shutting_down.connect(on_stop, weak=False)
    worker = create_app(workshop, crew).Worker(
        pool=BellTaskPool,
        concurrency=1,  # it only passes bells on
        queues=heard_queues(settings),
        hostname=f"integument@{workshop.name}",
        loglevel="INFO",
        quiet=True,  # its banner is no line of a log
        without_gossip=True,
        without_mingle=True,
        without_heartbeat=True,
        task_events=False,
    )
    try:
        worker.start()
    finally:
        workshop.closing.begin()
        crew.drain()
        reconciler.stop()
        deliverer.stop(settings.drain_s)
        for one in rounds:
            one.stop()
        checkpointer.stop()
        presence.leave()
        workshop.nursery.stop()
        workshop.announce_all(workshop.closing.left)
        workshop.close()
        liveness.end()
    return int(worker.exitcode or 0)
