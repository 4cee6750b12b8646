"""One worker of all reconciles; when it is killed or paused another follows, and what it owed is done."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from core.errors import InternalError
from store.crew_records import LeaderRow
from store.job import JobStatus
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.postgres import running_postgres
from tests.valkey import ValkeyServer
from tests.worker.conftest import LIMIT_S, Service, make_settings
from worker.liveness import Liveness
from worker.reconciler import OFFICE, Reconciler, patience_after_outage_s, recovery_s
from worker.workshop import Workshop


@pytest.fixture
def workshop(settings: Settings) -> Iterator[Workshop]:
    workshop = Workshop.open(settings)
    workshop.db.migrate()
    yield workshop
    workshop.close()


def leader(service: Service) -> int:
    """The pid of the worker that leads."""
    deadline = time.monotonic() + 3 * LIMIT_S
    while True:
        with service.db.reading() as session:
            row = session.get(LeaderRow, OFFICE)
            if row is not None and row.holder:
                return int(row.holder.rpartition(":")[2])
        assert time.monotonic() < deadline, service.log()
        time.sleep(0.02)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_another_follows_a_leader_that_is_gone(service: Service, number: signal.Signals) -> None:
    workers = {worker.pid: worker for worker in (service.start_worker(), service.start_worker())}
    first = leader(service)
    job = service.submit("sleep", seconds=60)
    service.wait_for_child(job)
    with service.db.session():  # whoever is stopped in the middle of writing keeps SQLite's turn until he goes on
        os.kill(first, number)
    deadline = time.monotonic() + 3 * LIMIT_S
    while (second := leader(service)) == first:
        assert time.monotonic() < deadline, service.log()
        time.sleep(0.05)
    assert second in workers
    unheard = service.submit(ring=False)  # only a leader finds it
    assert service.wait(unheard).status is JobStatus.SUCCESSFUL
    os.kill(first, signal.SIGKILL)
    service.workers.remove(workers[first])
    workers[first].wait()


def test_only_who_leads_looks_after_jobs(workshop: Workshop) -> None:
    settings = workshop.settings.model_copy(update={"reconcile_s": 60})  # nobody is silent for so long that he is followed
    first, second = (
        Reconciler(replace(shop, settings=settings), Liveness(settings)) for shop in (Workshop.open(settings), workshop)
    )
    first._leadership._candidate = "another:1"
    first.look()
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {})
    second.look()
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).rung_at is None
    first._leadership.resign()
    second.look()
    assert workshop.jobs.get(DEFAULT_WORKSPACE, job.id).rung_at is not None


def test_a_leader_without_a_broker_lets_another_try(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    reconciler, other = (Reconciler(workshop, Liveness(workshop.settings)) for _ in range(2))
    other._leadership._candidate = "another:1"
    workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {})
    monkeypatch.setattr(workshop.doorbell, "ring", lambda *_: False, raising=True)
    reconciler.look()
    assert other._leadership.campaign()


def test_a_database_that_is_away_is_waited_for(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    reconciler = Reconciler(workshop, Liveness(workshop.settings))

    def away() -> bool:
        raise InternalError("database.unavailable", "away")

    monkeypatch.setattr(reconciler._leadership, "campaign", away)
    with pytest.raises(InternalError):
        reconciler.look()
    assert Liveness(workshop.settings).is_fresh(), "the worker itself lives"


def test_after_an_outage_of_the_database_the_living_keep_their_jobs(tmp_path: Path, valkey: ValkeyServer) -> None:
    with running_postgres() as server:
        settings = make_settings(
            tmp_path, valkey, database_url=server.new_database(), lease_s=3.0, heartbeat_s=1.0, reconcile_s=0.3
        )
        workshop = Workshop.open(settings)
        workshop.db.migrate()
        alive, dead = (workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {}) for _ in range(2))
        tokens = {job.id: mine.lease_token for job in (alive, dead) if (mine := workshop.jobs.claim(job.id, 1, "me", 3.0))}
        reconciler = Reconciler(workshop, Liveness(settings))
        reconciler.start()
        workshop.jobs.renew(alive.id, tokens[alive.id], 3.0)
        server.signal(signal.SIGSTOP)
        time.sleep(4.0)
        server.signal(signal.SIGCONT)
        time.sleep(1.0)  # the reconciler looks before anybody renews
        deadline = time.monotonic() + LIMIT_S
        while workshop.jobs.get(DEFAULT_WORKSPACE, dead.id).attempt == 1:
            assert workshop.jobs.renew(alive.id, tokens[alive.id], 3.0).kept
            assert time.monotonic() < deadline
            time.sleep(0.2)
        assert workshop.jobs.get(DEFAULT_WORKSPACE, alive.id).attempt == 1
        reconciler.stop()
        workshop.close()


def test_the_settings_promise_a_killed_workers_job_within_a_minute(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path)
    assert patience_after_outage_s(settings) == 17.0
    assert recovery_s(settings) == 30.0 + 17.0 + 5.0
    short = settings.model_copy(update={"lease_s": 6.0, "reconcile_s": 2.0})
    assert patience_after_outage_s(short) == 6.0
    assert recovery_s(short) == 8.0 + 6.0 + 2.0, "the leader is followed later than the lease lapses"


def test_late_rounds_do_not_put_off_the_end_of_a_lease_for_ever(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine so loaded that every round comes late, and a worker that is gone."""
    reconciler, now = Reconciler(workshop, Liveness(workshop.settings)), [1000.0]
    monkeypatch.setattr("worker.reconciler.time", SimpleNamespace(monotonic=lambda: now[0]))
    reconciler._heard_at = now[0]
    job = workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {})
    assert workshop.jobs.claim(job.id, 1, "gone", 0.0) is not None
    late_s, patience_s = workshop.settings.lease_s * 0.75, patience_after_outage_s(workshop.settings)
    looks, killed_at = 0, now[0]
    while workshop.jobs.get(DEFAULT_WORKSPACE, job.id).attempt == 1:
        now[0] += late_s
        reconciler.look()
        looks += 1
        assert now[0] - killed_at <= patience_s + 2 * late_s, looks
    assert looks > 1, "the first late round gives the living their time"
