"""The job table against a model of it in plain Python: any order of calls by users, workers and the reconciler."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, invariant, precondition, rule, run_state_machine_as_test
from sqlalchemy import delete

from core.errors import StateError
from store.database import Database
from store.events import Events
from store.jobs import Jobs
from store.records import JobRow
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import CRASHED, PACKAGE

MUCH_LATER = timedelta(days=1)
LEASE_S = 3600.0


@dataclass
class Expected:
    """What the table must say of one job."""

    status: str = "accepted"
    attempt: int = 1
    max_attempts: int = 2
    token: int = 0
    dismissing: bool = False
    story: list[str] = field(default_factory=lambda: ["accepted"])

    def become(self, status: str, *, attempt: int | None = None) -> None:
        self.status = status
        self.attempt = attempt or self.attempt
        self.dismissing = False
        self.story.append(status)

    def lose_attempt(self) -> None:
        if self.dismissing:
            self.become("dismissed")
        elif self.attempt < self.max_attempts:
            self.become("accepted", attempt=self.attempt + 1)
        else:
            self.become("failed")


class JobMachine(RuleBasedStateMachine):
    """Three jobs at most: the fewer, the more often calls meet."""

    db: Database

    def __init__(self) -> None:
        super().__init__()
        self.jobs, self.events = Jobs(self.db), Events(self.db)
        self.expected: dict[str, Expected] = {}

    ids = Bundle("ids")
    tokens = st.integers(0, 4)

    @precondition(lambda self: len(self.expected) < 3)
    @rule(target=ids, max_attempts=st.integers(1, 3))
    def create(self, max_attempts: int) -> str:
        job_id = self.jobs.create(DEFAULT_WORKSPACE, "shells", {}, max_attempts=max_attempts).id
        self.expected[job_id] = Expected(max_attempts=max_attempts)
        return job_id

    @rule(job_id=ids, stale=st.sampled_from([0, 0, 0, -1, 1]))
    def claim(self, job_id: str, stale: int) -> None:
        known = self.expected.get(job_id)
        attempt = (known.attempt if known else 1) + stale
        job = self.jobs.claim(job_id, attempt, "worker", LEASE_S)
        if known is None or known.status != "accepted" or stale:
            assert job is None
            return
        assert job is not None
        known.token += 1
        assert (job.lease_token, job.attempt) == (known.token, attempt)
        known.become("running")

    def holds(self, job_id: str, token: int) -> Expected | None:
        known = self.expected.get(job_id)
        return known if known and known.status == "running" and known.token == token else None

    @rule(job_id=ids, token=tokens, progress=st.floats(0, 100))
    def renew(self, job_id: str, token: int, progress: float) -> None:
        known = self.holds(job_id, token)
        renewal = self.jobs.renew(job_id, token, LEASE_S, progress)
        assert (renewal.kept, renewal.dismiss_requested) == (known is not None, known is not None and known.dismissing)

    @rule(job_id=ids, token=tokens)
    def finish(self, job_id: str, token: int) -> None:
        known = self.holds(job_id, token)
        done = self.jobs.finish(job_id, token, verdict="not_ready", summary="", outputs={"package": PACKAGE}, timings_s={})
        assert done is (known is not None and not known.dismissing)
        if known:
            known.become("dismissed" if known.dismissing else "successful")

    @rule(job_id=ids, token=tokens, retry=st.booleans())
    def fail(self, job_id: str, token: int, retry: bool) -> None:
        known = self.holds(job_id, token)
        job = self.jobs.fail(job_id, token, CRASHED, retry=retry)
        if known is None:
            assert job is None
            return
        if retry:
            known.lose_attempt()
        else:
            known.become("dismissed" if known.dismissing else "failed")
        assert job is not None
        assert job.status == known.status

    @rule(job_id=ids, token=tokens)
    def release(self, job_id: str, token: int) -> None:
        known = self.holds(job_id, token)
        assert self.jobs.release(job_id, token) is (known is not None)
        if known:
            known.become("dismissed" if known.dismissing else "accepted")

    @rule(job_id=ids, token=tokens)
    def confirm_dismissed(self, job_id: str, token: int) -> None:
        known = self.holds(job_id, token)
        assert self.jobs.confirm_dismissed(job_id, token) is (known is not None and known.dismissing)
        if known and known.dismissing:
            known.become("dismissed")

    @rule(job_id=ids)
    def dismiss(self, job_id: str) -> None:
        known = self.expected.get(job_id)
        if known is None:
            with pytest.raises(StateError):
                self.jobs.dismiss(DEFAULT_WORKSPACE, job_id)
            return
        job = self.jobs.dismiss(DEFAULT_WORKSPACE, job_id)
        if known.status == "accepted":
            known.become("dismissed")
        elif known.status == "running":
            if not known.dismissing:
                known.story.append("running")
            known.dismissing = True
        else:
            del self.expected[job_id]
            assert job.status == "dismissed"
            assert self.events.after(DEFAULT_WORKSPACE, job_id) == []

    @rule(job_id=ids)
    def retry(self, job_id: str) -> None:
        known = self.expected.get(job_id)
        if known is None or known.status not in ("failed", "dismissed"):
            with pytest.raises(StateError):
                self.jobs.retry(DEFAULT_WORKSPACE, job_id)
            return
        self.jobs.retry(DEFAULT_WORKSPACE, job_id)
        known.max_attempts = max(known.max_attempts, known.attempt + 1)
        known.become("accepted", attempt=known.attempt + 1)

    @rule(everywhere=st.booleans())
    def expire(self, everywhere: bool) -> None:
        assert self.jobs.expire_leases() == []
        expired = self.jobs.expire_all_leases() if everywhere else self.jobs.expire_leases(datetime.now(UTC) + MUCH_LATER)
        lost = {job_id for job_id, known in self.expected.items() if known.status == "running"}
        assert {job.id for job in expired} == lost
        for job_id in lost:
            self.expected[job_id].lose_attempt()

    @invariant()
    def table_agrees(self) -> None:
        rows = {job.id: job for job in self.jobs.list(DEFAULT_WORKSPACE).items}
        assert rows.keys() == self.expected.keys()
        for job_id, known in self.expected.items():
            row = rows[job_id]
            assert (row.status, row.attempt, row.max_attempts, row.lease_token, row.dismiss_requested) == (
                known.status,
                known.attempt,
                known.max_attempts,
                known.token,
                known.dismissing,
            )
            assert (row.lease_until is not None) == (row.status == "running")
            assert (row.finished_at is not None) == row.status.is_finished
            assert (row.failure is not None) == (row.status == "failed")
            assert list(row.outputs) == (["package"] if row.status == "successful" else [])
            story = self.events.after(DEFAULT_WORKSPACE, job_id)
            assert [event.seq for event in story] == list(range(1, row.event_seq + 1))
            assert [event.data["status"] for event in story if event.type != "progress"] == known.story
            assert all((event.type == "done") == (event.data.get("status") in FINISHED) for event in story)
        waiting = {(job_id, known.attempt) for job_id, known in self.expected.items() if known.status == "accepted"}
        assert set(self.jobs.due_to_ring(0.0)) == waiting

    def teardown(self) -> None:
        with self.db.session() as session:
            session.execute(delete(JobRow))


FINISHED = ("successful", "failed", "dismissed")


def test_any_order_of_calls_keeps_the_table_true(db: Database) -> None:
    machine = type("Machine", (JobMachine,), {"db": db})
    checks = settings(
        max_examples=15,
        stateful_step_count=25,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    run_state_machine_as_test(machine, settings=checks)
