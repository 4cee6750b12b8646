"""Puts right, every few seconds, what dead workers, a restarted broker and power cuts left behind."""

from __future__ import annotations

import logging
import threading
import time

from core.errors import IntegumentError
from worker.job_folder import sweep_job_folders
from worker.liveness import Liveness
from worker.workshop import Workshop

logger = logging.getLogger(__name__)

SWEEP_S = 600.0
BLOB_GRACE_S = 3600.0  # a blob without a row may belong to an upload whose row is just being written


class Reconciler:
    """A thread of the worker. Several workers reconcile at once without harm: every act is one transaction."""

    def __init__(self, workshop: Workshop, liveness: Liveness) -> None:
        self._workshop = workshop
        self._liveness = liveness
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._loop, name="reconciler", daemon=True)
        self._swept_at = -SWEEP_S

    def start(self) -> None:
        """Begin with a look at once."""
        self._thread.start()

    def let_go(self) -> None:
        """Look no more; what the closing worker hands back it announces itself."""
        self._stop.set()

    def stop(self) -> None:
        """Returns when the present look is over."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def reconcile(self) -> None:
        """One look: lost leases first, then whoever waits unheard."""
        for job in self._workshop.jobs.expire_leases():
            logger.warning("job %s: its worker fell silent; it is %s now, attempt %d", job.id, job.status, job.attempt)
        for job_id, attempt in self._workshop.jobs.due_to_ring(self._workshop.settings.rering_s):
            if not self._workshop.announce(job_id, attempt):
                return

    def sweep(self) -> None:
        """Remove folders of attempts nobody works on, blobs nobody refers to and idempotency keys of yesterday."""
        for folder in sweep_job_folders(self._workshop.settings.scratch_dir, self._workshop.jobs):
            logger.info("removed the orphan %s", folder)
        referenced = self._workshop.references.all()
        if swept := self._workshop.blobs.sweep(referenced, BLOB_GRACE_S):
            logger.info("removed %d unused blobs, %d bytes", len(swept), sum(blob.size for blob in swept))
        if aged := self._workshop.audit.sweep(self._workshop.settings.audit_days):
            logger.info("forgot %d entries of the audit log", aged)
        if forgotten := self._workshop.keys.sweep():
            logger.info("forgot %d idempotency keys", forgotten)

    def _loop(self) -> None:
        while True:
            try:
                self._liveness.beat()
                self.reconcile()
                if time.monotonic() - self._swept_at >= SWEEP_S:
                    self.sweep()
                    self._swept_at = time.monotonic()
            except IntegumentError as error:
                logger.warning("the reconciler waits: %s", error)
            except Exception:
                logger.exception("the reconciler stumbled and goes on")
            if self._stop.wait(self._workshop.settings.reconcile_s):
                return
