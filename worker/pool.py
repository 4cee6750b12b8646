"""Celery's thread pool with a bell: the end of a task wakes the loop that takes messages.

With `worker_disable_prefetch` the loop stops asking the broker while every thread is busy, and nothing tells it that one is free
again: without the bell it looks once a second only, which is what every short job in a queue then takes."""

from __future__ import annotations

import os
from typing import Any

from celery.concurrency.thread import TaskPool


class BellTaskPool(TaskPool):  # type: ignore[misc]  # Celery has no types
    """Threads; a task only supervises a child process, so the interpreter's lock does not matter."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._bell = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)

    def register_with_event_loop(self, hub: Any) -> None:
        """Called by Celery whenever its loop (re)starts."""
        hub.add_reader(self._bell, os.eventfd_read, self._bell)

    def on_apply(self, *args: Any, **kwargs: Any) -> Any:
        """Run a task, and ring when its slot is free again."""
        result = super().on_apply(*args, **kwargs)
        result.f.add_done_callback(lambda _future: os.eventfd_write(self._bell, 1))
        return result
