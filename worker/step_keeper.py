"""The steps of one attempt: those kept before are laid out for the child, new ones are stored while it goes on."""

from __future__ import annotations

import logging
import os
import re
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, wait
from functools import partial
from pathlib import Path
from typing import Any, Protocol, TypeVar

from core.errors import IntegumentError
from store.checkpoint import Checkpoint
from store.checkpoints import MOST
from store.job import Job
from worker.outage import sit_out
from worker.workshop import Workshop

logger = logging.getLogger(__name__)

KEY = re.compile(r"[0-9a-f]{64}\Z")
PATIENCE_S = 10.0  # with a database or store that is away: a step that is not kept can be made again
LOOK_S = 0.2

T = TypeVar("T")


class Patiently(Protocol):
    """Does slow work, again while database or store are away, and keeps the lease meanwhile."""

    def __call__(self, work: Callable[[], T]) -> T:
        """What the work returns; raises what it raises."""
        ...


class StepKeeper:
    """For one attempt; `hear` never waits. The child has read untrusted bytes: of what it says only the key is used."""

    def __init__(self, workshop: Workshop, job: Job) -> None:
        self._workshop = workshop
        self._job = job
        self._folder: int | None = None
        self._heard: set[str] = set()
        self._waiting: set[Future[None]] = set()
        self._storing = ThreadPoolExecutor(max_workers=1, thread_name_prefix="steps")
        self._closed = False

    def lay_out(self, folder: Path, given: Path, patiently: Patiently) -> dict[str, Any] | None:
        """What the child is told: where kept steps are and where new ones go; None if none are to be kept.

        A step whose bytes are gone is made again."""
        settings = self._workshop.settings
        if not settings.checkpoint_bytes:
            return None
        own = folder / "steps"
        own.mkdir(mode=0o700)
        self._folder = os.open(own, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)  # whatever the child puts in its place later
        kept: dict[str, str] = {}
        room = int(settings.checkpoint_bytes)
        for step in patiently(partial(self._workshop.checkpoints.of, self._job.id)):
            try:
                kept[step.key] = str(patiently(partial(self._workshop.blobs.fetch, step.sha256, given)))
                room -= step.size
            except IntegumentError as error:
                logger.warning("job %s: step '%s' cannot be had and is made again: %s", self._job.id, step.stage, error)
        return {"folder": str(own), "kept": kept, "worth_s": settings.checkpoint_after_s, "room_bytes": max(room, 0)}

    def hear(self, message: Mapping[str, Any]) -> None:
        """Take {"kind": "checkpoint", "key", "stage"}; anything else is not for us."""
        key, stage = message.get("key"), message.get("stage")
        if message.get("kind") != "checkpoint" or self._folder is None or self._closed:
            return
        if not (isinstance(key, str) and KEY.match(key) and isinstance(stage, str)) or len(self._heard) >= MOST:
            logger.warning("job %s: its child tells of a step in a form nobody understands", self._job.id)
        elif key not in self._heard:
            self._heard.add(key)
            self._waiting.add(self._storing.submit(self._store, self._folder, key, stage))

    def flush(self, beat: Callable[[], None], patience_s: float = PATIENCE_S) -> None:
        """Give what was heard some time to be stored, so that the next attempt has it."""
        deadline = time.monotonic() + patience_s
        while self._waiting and time.monotonic() < deadline:
            self._waiting = set(wait(self._waiting, LOOK_S).not_done)
            beat()

    def close(self) -> None:
        """What is not stored by now never will be. Does not wait."""
        self._closed = True
        if self._folder is not None:
            self._storing.submit(os.close, self._folder)
            self._folder = None
        self._storing.shutdown(wait=False)

    def _store(self, folder: int, key: str, stage: str) -> None:
        path = Path(f"/proc/self/fd/{folder}/{key}.step")
        try:
            if not self._closed:
                sit_out(partial(self._write_down, key, stage, path), PATIENCE_S)
                path.unlink(missing_ok=True)
        except (IntegumentError, OSError) as error:
            logger.warning("job %s: step '%s' is not kept: %s", self._job.id, stage, error)

    def _write_down(self, key: str, stage: str, path: Path) -> None:
        blob = self._workshop.blobs.put_file(path)
        step = Checkpoint(key, stage, blob.sha256, blob.size)
        if self._workshop.checkpoints.keep(self._job.id, self._job.lease_token, step):
            logger.info("job %s: kept step '%s', %d bytes", self._job.id, stage, blob.size)
