"""The worker's word in the table of workers: what `/readyz`, the metrics and `doctor` know of it."""

from __future__ import annotations

import shutil
import socket

from core.errors import IntegumentError
from store.version import SERVER_VERSION
from store.workers import Workers, WorkerWord
from worker.closing import Closing
from worker.workshop import Workshop


class Presence:
    """Speaks for one worker process."""

    def __init__(self, workshop: Workshop) -> None:
        self._settings = workshop.settings
        self._closing: Closing = workshop.closing
        self._name = workshop.name
        self._workers = Workers(workshop.db, workshop.settings)

    def beat(self) -> None:
        """I live; the rows of those that vanished long ago go on the way."""
        self._workers.beat(self.word())
        self._workers.sweep()

    def word(self) -> WorkerWord:
        """What it says now."""
        return WorkerWord(
            name=self._name,
            host=socket.gethostname(),
            version=SERVER_VERSION,
            concurrency=self._settings.worker_concurrency,
            memory_bytes=self._settings.worker_memory_bytes,
            disk_free_bytes=shutil.disk_usage(self._settings.data_dir).free,
            draining=self._closing.has_begun,
            queues=self._settings.worker_queues,
        )

    def leave(self) -> None:
        """The last word; a database that is away hears nothing, and finds out by itself."""
        try:
            self._workers.leave(self._name)
        except IntegumentError:
            return
