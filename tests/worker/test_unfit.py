"""Jobs larger than every host that is there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.schema.expectation import Expectation
from store.job import JobStatus
from store.settings import Settings
from store.workers import Workers
from store.workspace import DEFAULT_WORKSPACE
from tests.valkey import ValkeyServer
from tests.worker.conftest import make_settings
from worker.liveness import Liveness
from worker.presence import Presence
from worker.reconciler import Reconciler
from worker.supervise import supervise
from worker.workshop import Workshop

MIB = 1024**2
LARGE = Expectation(400 * MIB, 60.0)


@pytest.fixture
def open_workshop(tmp_path: Path) -> Iterator[Callable[..., Workshop]]:
    """On a host whose jobs may use 300 MiB together, where one job may use 512 MiB elsewhere."""
    with ExitStack() as opened:

        def make(**changes: Any) -> Workshop:
            small = {"worker_memory_bytes": 300 * MIB, "job_memory_bytes": 512 * MIB, **changes}
            settings: Settings = make_settings(tmp_path, ValkeyServer(tmp_path), **small)
            workshop = Workshop.open(settings, target="tests.worker.targets:run")
            opened.callback(workshop.close)
            workshop.db.migrate()
            return workshop

        yield make


def test_a_job_waits_for_a_larger_host_and_then_fails_by_name(open_workshop: Callable[..., Workshop]) -> None:
    workshop = open_workshop(host_wait_s=0.001)
    presence = Presence(workshop)
    presence.beat()
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {}, expectation=LARGE)
    workshop.jobs.mark_all_rung([(job.id, 1)])
    workers = Workers(workshop.db, workshop.settings)
    workers.beat(replace(presence.word(), name="other:1", host="other", memory_bytes=8 * 1024 * MIB))
    Reconciler(workshop, Liveness(workshop.settings)).reconcile()
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.ACCEPTED, "the other host can hold it"
    workers.leave("other:1")
    Reconciler(workshop, Liveness(workshop.settings)).reconcile()
    failed = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert failed.failure is not None
    assert (failed.failure.code, failed.failure.facts["limit_bytes"]) == ("job.too_large_for_memory", 300 * MIB)


def test_what_outgrows_a_small_host_is_left_to_a_larger_one(open_workshop: Callable[..., Workshop]) -> None:
    workshop = open_workshop()
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {"act": "fill_bytearray"}, expectation=Expectation(100 * MIB, 1.0))
    claimed = workshop.jobs.claim(job.id, 1, "me", 30)
    assert claimed is not None
    supervise(workshop, claimed)
    again = workshop.jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (again.status, again.attempt) == (JobStatus.ACCEPTED, 2), again.failure
    assert again.expected_memory_bytes > 150 * MIB
