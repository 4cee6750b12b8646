"""The one look at the database for all who wait for news of jobs."""

from __future__ import annotations

import asyncio
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

import pytest

from api.drain import Drain
from api.job_watch import JobWatch
from store.database import Database
from store.job_heads import JobHead, JobHeads
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE

POLL_S = 0.01


class CountedHeads(JobHeads):
    """How often was the database asked, and for how many jobs at the most?"""

    looks = 0
    most = 0

    def of(self, job_ids: Collection[str]) -> Mapping[str, JobHead]:
        self.looks, self.most = self.looks + 1, max(self.most, len(job_ids))
        return super().of(job_ids)


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    yield database
    database.close()


def test_one_query_serves_all_who_wait(database: Database) -> None:
    jobs, heads, drain = Jobs(database), CountedHeads(database), Drain()
    waited_for = [jobs.create(DEFAULT_WORKSPACE, "validate", {}) for _ in range(5)]
    watch = JobWatch(heads, drain, POLL_S)

    async def listener(number: int) -> bool:
        job = waited_for[number % len(waited_for)]
        with watch.watching(job.id) as watched:
            while watched.head is not None and not watched.head.finished:
                await watched.news(watched.head.seq, 10.0)
            return watched.head is not None

    async def run() -> list[bool]:
        looking = asyncio.create_task(watch.run())
        listeners = [asyncio.create_task(listener(number)) for number in range(50)]
        await asyncio.sleep(10 * POLL_S)
        for job in waited_for:
            jobs.dismiss(DEFAULT_WORKSPACE, job.id)
        ended = await asyncio.gather(*listeners)
        before = heads.looks
        await asyncio.sleep(10 * POLL_S)
        assert heads.looks <= before + 1, "nobody waits, nobody looks"
        looking.cancel()
        return list(ended)

    assert all(asyncio.run(run()))
    assert heads.most == 5


def test_a_removed_job_and_the_end_of_the_server_wake_those_who_wait(database: Database) -> None:
    jobs, drain = Jobs(database), Drain()
    gone, kept = (jobs.create(DEFAULT_WORKSPACE, "validate", {}) for _ in range(2))
    watch = JobWatch(JobHeads(database), drain, POLL_S)

    async def run() -> None:
        looking = asyncio.create_task(watch.run())
        with watch.watching(gone.id) as removed, watch.watching(kept.id) as other:
            await removed.news(0, 10.0)
            jobs.dismiss(DEFAULT_WORKSPACE, gone.id)
            jobs.dismiss(DEFAULT_WORKSPACE, gone.id)
            while removed.head is not None:
                await removed.news(removed.head.seq, 10.0)
            waiting = asyncio.create_task(other.news(1_000_000, 30.0))
            await asyncio.sleep(POLL_S)
            drain.begin()
            await asyncio.wait_for(waiting, 5.0)
        await asyncio.wait_for(looking, 5.0)

    asyncio.run(run())


def test_what_was_told_already_is_no_news(database: Database) -> None:
    job = Jobs(database).create(DEFAULT_WORKSPACE, "validate", {})
    watch = JobWatch(JobHeads(database), Drain(), POLL_S)

    async def run() -> bool:
        looking = asyncio.create_task(watch.run())
        with watch.watching(job.id) as watched:
            await watched.news(0, 10.0)
            waiting = asyncio.create_task(watched.news(job.event_seq, 30.0))
            await asyncio.sleep(20 * POLL_S)
            woken = waiting.done()
            waiting.cancel()
        looking.cancel()
        return woken

    assert not asyncio.run(run())
