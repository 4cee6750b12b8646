"""One attempt of one job: a child does the work, we watch it, keep the lease, and write down how it ended."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from core.errors import IntegumentError
from sandbox.log_cap import cap_log
from sandbox.outcome import Outcome, log_tail
from sandbox.overrun import find_overrun
from store.job import Job, JobFailure, JobOutput
from store.lost_attempt import LastWords
from worker.aside import work_aside
from worker.child_result import ChildResult, ListedOutput, read_outputs, read_result, store_outputs
from worker.job_folder import job_folder
from worker.last_words import last_words
from worker.lease import DismissedError, Lease, LeaseLostError, ToldToStopError
from worker.outage import sit_out
from worker.progress import Progress
from worker.scratch_room import room_needed
from worker.stage_log import StageLog
from worker.step_keeper import StepKeeper
from worker.workshop import Workshop

logger = logging.getLogger(__name__)

WATCH_S = 0.2  # between looks at memory, clock and disk
LOADING = {
    "kind": "progress",
    "progress": 0.0,
    "phase": "load the libraries",
    "message": "libraries are being loaded; after an installation or update kernels are compiled, which takes some seconds",
}
# another attempt may fare better; a worker whose disk is full claims nothing until there is room
RETRIED_CODES = frozenset({"child.crashed", "nursery.lost", "nursery.fork_failed", "storage.full", "blobs.unavailable"})

T = TypeVar("T")


def supervise(workshop: Workshop, job: Job, leave: Callable[[], None] = lambda: None) -> None:
    """Bring a claimed job to an end, or give it back; `leave` is called when its child is dead, before anything is stored.

    What happens to the child never raises; a broken disk or database may."""
    stages = StageLog()
    progress = Progress(stages.follow)
    steps = StepKeeper(workshop, job)
    attempt = _Attempt(workshop, job, progress, Lease(workshop, job, progress), steps, leave)
    with job_folder(workshop.settings.scratch_dir, job) as folder, closing(steps), stages:
        stages.follow(progress.phase)
        try:
            attempt.run(folder)
        except LeaseLostError:
            logger.warning("job %s: lost the lease, its child is ended", job.id)
        except DismissedError:
            sit_out(lambda: workshop.jobs.confirm_dismissed(job.id, job.lease_token))
        except ToldToStopError:
            steps.flush(lambda: None, workshop.settings.lease_s / 3)
            if sit_out(lambda: workshop.jobs.release(job.id, job.lease_token)):
                workshop.closing.left.append((job.id, job.attempt))


class _Attempt:
    def __init__(
        self, workshop: Workshop, job: Job, progress: Progress, lease: Lease, steps: StepKeeper, leave: Callable[[], None]
    ) -> None:
        self._workshop = workshop
        self._job = job
        self._progress = progress
        self._lease = lease
        self._steps = steps
        self._leave = leave
        self._peak_bytes: int | None = None
        self._last_words = LastWords()
        self._left: tuple[dict[str, Any], ...] = ()  # files the child said would stay if it was ended

    def run(self, folder: Path) -> None:
        """Raises LeaseLostError, DismissedError, ToldToStopError; the child is dead whenever this ends."""
        left: tuple[dict[str, Any], ...] = ()
        try:
            outcome = self._work(folder)
            self._leave()
            self._peak_bytes = outcome.peak_bytes
            self._last_words = last_words(outcome, self._progress.phase, folder)
            left = outcome.outputs or self._left
            if outcome.error is not None:
                raise outcome.error
            result = read_result(outcome.result or {})
            outputs = self._store(result.outputs, folder)
        except IntegumentError as error:
            self._log(error, folder)
            self._steps.flush(self._lease.beat)
            self._fail(error, left, folder)
        else:
            self._finish(result, outputs)

    def _work(self, folder: Path) -> Outcome:
        """The child from spawn to end; its error is replaced by the limit it was killed for."""
        self._await_nursery()
        payload = self._payload(folder)
        kept = payload.get("checkpoints", {}).get("kept", {})
        inputs = [*(Path(mesh["path"]) for mesh in payload["meshes"].values()), *map(Path, kept.values())]
        limits = self._workshop.limits_of(self._job.process)
        child = self._workshop.nursery.spawn(self._workshop.target, payload, limits, folder, inputs)
        overrun: IntegumentError | None = None
        look_at = 0.0
        with child:
            while (outcome := child.outcome()) is None:
                for message in child.events(WATCH_S):
                    self._progress.hear(message)
                    self._steps.hear(message)
                    self._hear_left(message)
                self._lease.peak_bytes = child.peak_bytes
                self._lease.beat()
                if (now := time.monotonic()) < look_at:  # a child that says much is not looked at each time
                    continue
                look_at = now + WATCH_S
                cap_log(folder)
                if overrun is None and (overrun := find_overrun(child)) is not None:
                    child.kill()
        return outcome if overrun is None else Outcome(None, overrun, (), outcome.exit_code, outcome.peak_bytes)

    def _hear_left(self, message: Mapping[str, Any]) -> None:
        """Take {"kind": "left", "outputs"}; they are read when they are needed (`read_outputs`)."""
        outputs = message.get("outputs")
        if message.get("kind") == "left" and isinstance(outputs, list):
            self._left = tuple(outputs)

    def _await_nursery(self) -> None:
        """The lease must be kept while the nursery loads, too."""
        patience = int(self._workshop.nursery.ready_timeout_s / WATCH_S)
        for number in range(patience):
            if self._workshop.nursery.wait_until_ready(WATCH_S):
                return
            if number == 0:
                self._progress.hear(LOADING)
            self._lease.beat()

    def _payload(self, folder: Path) -> dict[str, Any]:
        out, given = folder / "out", folder / "in"
        with room_needed():
            for here in (out, given):
                here.mkdir(mode=0o700)
        meshes = {}
        for href, mesh in self._job.mesh_inputs.items():
            path = self._keep_beating(partial(self._workshop.blobs.fetch, mesh.sha256, given))
            meshes[href] = {
                "path": str(path),
                "name": mesh.name,
                "sha256": mesh.source_sha256 or mesh.sha256,
                "media_type": mesh.media_type,
                "file_name": mesh.file_name,
            }
        payload = {"process": self._job.process, "inputs": dict(self._job.inputs), "meshes": meshes, "out_dir": str(out)}
        steps = self._steps.lay_out(folder, given, self._keep_beating)
        return payload if steps is None else {**payload, "checkpoints": steps}

    def _store(self, listed: Iterable[ListedOutput], folder: Path) -> dict[str, JobOutput]:
        self._progress.enter("store")
        return self._keep_beating(partial(store_outputs, tuple(listed), folder, self._workshop.blobs))

    def _finish(self, result: ChildResult, outputs: dict[str, JobOutput]) -> None:
        news = self._progress.news()  # goes along: one transaction, not two
        kept = sit_out(
            lambda: self._workshop.jobs.finish(
                self._job.id,
                self._job.lease_token,
                verdict=result.verdict,
                summary=result.summary,
                outputs=outputs,
                timings_s=self._progress.timings_s(),
                peak_memory_bytes=self._peak_bytes,
                progress=news.progress,
                phase=news.phase,
                message=news.message,
                events=news.events,
            )
        )
        said = result.verdict if kept else "finished, but nobody wants it any more"
        logger.info("job %s: %s", self._job.id, said, extra={"event": "job_ended"})

    def _fail(self, error: IntegumentError, left: tuple[dict[str, Any], ...], folder: Path) -> None:
        """Write the failure down, with the report the child may have left; queue the job again if that may help."""
        outputs: dict[str, JobOutput] = {}
        try:
            outputs = self._store(read_outputs(left), folder)
        except IntegumentError as second:
            logger.error("job %s: the report of its failure cannot be kept: %s", self._job.id, second)
        self._lease.tell_all()
        job = sit_out(
            lambda: self._workshop.jobs.fail(
                self._job.id,
                self._job.lease_token,
                JobFailure.of(error),
                outputs=outputs,
                timings_s=self._progress.timings_s(),
                peak_memory_bytes=self._peak_bytes,
                retry=error.code in RETRIED_CODES or self._ran_out_of(error),
                last_words=self._last_words,
            )
        )
        if job is not None and not job.status.is_finished:
            self._workshop.announce_all([(job.id, job.attempt)])

    def _ran_out_of(self, error: IntegumentError) -> bool:
        """Whether it was the memory of this host, so that a larger one may do."""
        settings = self._workshop.settings
        return error.code == "limit.memory" and settings.worker_memory_bytes < settings.job_memory_bytes

    def _keep_beating(self, work: Callable[[], T]) -> T:
        """Do slow work with blobs, again while their store is away, and keep the lease."""
        return work_aside(work, self._lease.beat, WATCH_S)

    def _log(self, error: IntegumentError, folder: Path) -> None:
        """For the operator; what the child printed stays on the server."""
        if error.fault == "internal":
            extra = {"event": "job_failed", "fields": {"code": error.code}}
            logger.error("job %s attempt %d: %s", self._job.id, self._job.attempt, error, extra=extra)
            if tail := log_tail(folder).decode(errors="replace"):
                logger.error("job %s: the end of its child's log:\n%s", self._job.id, tail)
        else:
            extra = {"event": "job_failed", "fields": {"code": error.code}}
            logger.info("job %s attempt %d: %s: %s", self._job.id, self._job.attempt, error.code, error, extra=extra)
