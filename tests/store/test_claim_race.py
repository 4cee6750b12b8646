"""Many workers, one job: exactly one gets it. Real processes, because SQLite locks between processes, not threads."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter

from store.events import Events
from store.job import JobStatus
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE

PROCESSES, THREADS = 2, 4
JOBS = 25


def test_eight_claimants_share_no_job(jobs: Jobs, events: Events, settings: Settings) -> None:
    made = [jobs.create(DEFAULT_WORKSPACE, "shells", {}) for _ in range(JOBS)]
    claimants = [
        subprocess.Popen(
            [sys.executable, "-m", "tests.store.claimant", str(THREADS)],
            env={**os.environ, **settings.as_environment()},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for _ in range(PROCESSES)
    ]
    for claimant in claimants:
        assert claimant.stdout is not None
        assert claimant.stdout.readline() == "ready\n"
    for claimant in claimants:
        assert claimant.stdin is not None
        claimant.stdin.write(" ".join(job.id for job in made) + "\n")
        claimant.stdin.flush()
    won = Counter(line for claimant in claimants for line in claimant.communicate(timeout=60)[0].split())
    assert [claimant.returncode for claimant in claimants] == [0] * PROCESSES
    assert won == Counter(job.id for job in made)
    for job in made:
        now = jobs.get(DEFAULT_WORKSPACE, job.id)
        assert (now.status, now.lease_token) == (JobStatus.RUNNING, 1)
        assert [event.seq for event in events.after(DEFAULT_WORKSPACE, job.id)] == [1, 2]
