"""Celery's thread pool with a bell: the end of a task wakes the loop that takes messages.

With `worker_disable_prefetch` the loop stops asking the broker while every thread is busy, and nothing tells it that one is free
again: without the bell it looks once a second only, which is what every short job in a queue then takes."""

from __future__ import annotations

import os
from concurrent.futures import Future
from typing import Any

from celery.concurrency.thread import TaskPool
from celery.worker.state import task_ready


class BellTaskPool(TaskPool):  # type: ignore[misc]  # Celery has no types
    """Threads; a task only supervises a child process, so the interpreter's lock does not matter."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def register_with_event_loop(self, hub: Any) -> None:
        """Called by Celery whenever its loop (re)starts."""
        hub.add_reader(self._bell, os.eventfd_read, self._bell)

    def on_apply(self, *args: Any, callback: Any = None, **kwargs: Any) -> Any:
        """Run a task, and ring when its slot is free again.

        A message whose body cannot be read never becomes a task, and Celery counts it as under way for ever: with one slot, the
        worker would be deaf from then on."""

        def free(future: Future[Any]) -> None:
            if future.exception() is not None:
                task_ready(callback.__self__)
            os.eventfd_write(self._bell, 1)

        result = super().on_apply(*args, callback=callback, **kwargs)
        result.f.add_done_callback(free)
        return result
