"""Puts right, every few seconds, what dead workers, a restarted broker and power cuts left behind."""

from __future__ import annotations

import logging
import threading
import time

from core.errors import IntegumentError
from store.database import BUSY_TIMEOUT_S
from store.job import Job
from store.leadership import Leadership
from store.settings import Settings
from store.sqlite_file import SqliteFile
from store.unfit import Unfit
from store.workers import Workers, WorkerState
from worker.job_folder import sweep_job_folders
from worker.liveness import Liveness
from worker.outage import LONGEST_WAIT_S
from worker.workshop import Workshop

logger = logging.getLogger(__name__)

OFFICE = "reconciler"
LEAD_ROUNDS = 3  # a leader silent for so many rounds is followed by another
SWEEP_S = 600.0
BLOB_GRACE_S = 3600.0  # a blob without a row may belong to an upload whose row is just being written


class Reconciler:
    """A thread of the worker. One worker of all leads and looks after jobs and stored things; each after its own host.

    A leader that was paused and followed by another does no harm when it wakes up: every act is one transaction."""

    def __init__(self, workshop: Workshop, liveness: Liveness) -> None:
        self._workshop = workshop
        self._liveness = liveness
        self._leadership = Leadership(workshop.db, OFFICE, workshop.name, LEAD_ROUNDS * workshop.settings.reconcile_s)
        self._leads = False
        self._workers = Workers(workshop.db, workshop.settings)
        self._unfit = Unfit(workshop.db)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._loop, name="reconciler", daemon=True)
        self._tidied_at = self._swept_at = -SWEEP_S
        self._heard_at = time.monotonic()  # when the database last answered
        self._patient_until = 0.0
        self._was_patient = False  # and no lease was looked at since
        self._was_away = False

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

    def look(self) -> None:
        """One round. Raises IntegumentError; who cannot lead lets another."""
        self._liveness.beat()
        if time.monotonic() - self._tidied_at >= SWEEP_S:
            self.tidy()
            self._tidied_at = time.monotonic()
        leads = self._campaign()
        self._note_outage()
        if leads != self._leads:
            logger.info("%s %s the reconciler", self._workshop.name, "is now" if leads else "is no longer")
        self._leads = leads
        if not leads:
            return
        if not self.reconcile():  # the broker does not answer us; perhaps another
            self._leadership.resign()
        if time.monotonic() - self._swept_at >= SWEEP_S:
            self.sweep()
            self._swept_at = time.monotonic()

    def _campaign(self) -> bool:
        asked_at, known = time.monotonic(), self._was_away
        self._was_away = True  # unless it answers, and soon
        leads = self._leadership.campaign()
        self._was_away = known or time.monotonic() - asked_at > self._workshop.settings.lease_s / 4
        return leads

    def _note_outage(self) -> None:
        """A lease that lapsed while nobody could renew it says nothing about its holder: after a time without the database,
        whoever is alive gets the time to say so. Where only this thread was late, as on a machine that is much too busy, once:
        then leases are looked at before there is such a time again."""
        now, settings = time.monotonic(), self._workshop.settings
        if now - self._heard_at > settings.lease_s / 2 and (self._was_away or not self._was_patient):
            patience_s = patience_after_outage_s(settings)
            logger.warning("the database was away for %.0f s: no lease is ended for %g s", now - self._heard_at, patience_s)
            self._patient_until, self._was_patient = now + patience_s, True
        self._heard_at, self._was_away = now, False

    def tidy(self) -> None:
        """Remove the folders of attempts nobody works on, of this host."""
        for folder in sweep_job_folders(self._workshop.settings.scratch_dir, self._workshop.jobs):
            logger.info("removed the orphan %s", folder)

    def reconcile(self) -> bool:
        """Lost leases first, then whoever waits unheard; False if the broker does not answer."""
        if time.monotonic() >= self._patient_until:
            for job in self._workshop.jobs.expire_leases(within_s=self._workshop.settings.lease_s / 4):
                logger.warning("job %s: its worker fell silent; it is %s now, attempt %d", job.id, job.status, job.attempt)
            self._was_patient = False
        for job in self._fail_unfit():
            logger.warning("job %s: no worker host can hold it", job.id)
        for job in self._workshop.cohorts.close_ended():
            logger.info("job %s: the summary of a cohort whose jobs have all ended", job.id)
        return self._workshop.announce_all(self._workshop.jobs.due_to_ring(self._workshop.settings.rering_s))

    def _fail_unfit(self) -> list[Job]:
        settings = self._workshop.settings
        present = [worker.word for worker in self._workers.list() if worker.state is WorkerState.ALIVE]
        largest_bytes = max((word.memory_bytes for word in present), default=int(settings.worker_memory_bytes))
        return self._unfit.fail(largest_bytes, settings.job_memory_bytes, settings.host_wait_s)

    def sweep(self) -> None:
        """Remove what is too old, and blobs nobody refers to."""
        if not (expired := self._workshop.retention.sweep()).is_nothing:
            logger.info(
                "removed %d jobs, %d meshes, and the progress and log lines of %d jobs, all older than their days",
                expired.jobs,
                expired.meshes,
                expired.events_of,
            )
        if dropped := self._workshop.checkpoints.sweep(self._workshop.settings.checkpoint_days):
            logger.info("forgot %d steps of failed jobs", dropped)
        referenced = self._workshop.references.all()
        if swept := self._workshop.blobs.sweep(referenced, BLOB_GRACE_S):
            logger.info("removed %d unused blobs, %d bytes", len(swept), sum(blob.size for blob in swept))
        if aged := self._workshop.audit.sweep(self._workshop.settings.audit_days):
            logger.info("forgot %d entries of the audit log", aged)
        if released := self._workshop.parked.sweep(self._workshop.settings.parked_days):
            logger.info("released %d requests that were parked long ago", released)
        if forgotten := self._workshop.keys.sweep():
            logger.info("forgot %d idempotency keys", forgotten)
        if self._workshop.db.is_sqlite and (given_back := SqliteFile(self._workshop.db).give_back()):
            logger.info("the database file is %d bytes smaller", given_back)

    def _loop(self) -> None:
        while True:
            try:
                self.look()
            except IntegumentError as error:
                logger.warning("the reconciler waits: %s", error)
            except Exception:
                logger.exception("the reconciler stumbled and goes on")
            if self._stop.wait(self._workshop.settings.reconcile_s):
                break
        try:
            self._leadership.resign()
        except IntegumentError as error:
            logger.warning("the reconciler cannot hand over; another follows when its lease is over: %s", error)


def patience_after_outage_s(settings: Settings) -> float:
    """Until everybody alive has renewed his lease: one try that still hangs, the longest wait before the next, two heartbeats
    for the way. Never longer than a lease; a lost worker's job shall not wait for a whole one more."""
    return min(settings.lease_s, BUSY_TIMEOUT_S + LONGEST_WAIT_S + 2 * settings.heartbeat_s)


def recovery_s(settings: Settings) -> float:
    """In so many seconds the job of a worker that was killed waits again, where the machine leaves everybody his share.

    Its lease lapses, the next round sees it. A leader that was killed too is followed within the time of the lease. A database
    that comes back late, or a round that is late, puts the end off by the patience above: once, for it is not prolonged."""
    followed_s = LEAD_ROUNDS * settings.reconcile_s + settings.reconcile_s
    return max(settings.lease_s, followed_s) + patience_after_outage_s(settings) + settings.reconcile_s
