"""Values the store's tests share."""

from __future__ import annotations

from core.errors import InputError, InternalError
from store.job import Job, JobFailure, JobOutput
from store.jobs import Jobs
from store.workspace import DEFAULT_WORKSPACE

PACKAGE = JobOutput(sha256="a" * 64, size=12, media_type="application/zip", file_name="package.zip")
REPORT = JobOutput(sha256="b" * 64, size=34, media_type="application/json", file_name="report.json")
REFUSED = JobFailure.of(InputError("skin.not_closed", "the skin has 3 open edges", edges=3))
CRASHED = JobFailure.of(InternalError("child.crashed", "the child died of SIGSEGV", signal=11))


def claimed(jobs: Jobs, process: str = "shells") -> Job:
    """A new job, rung and running."""
    waiting = jobs.create(DEFAULT_WORKSPACE, process, {})
    jobs.mark_all_rung([(waiting.id, 1)])
    job = jobs.claim(waiting.id, 1, "worker-1", 30.0)
    assert job is not None
    return job


def finish(jobs: Jobs, job: Job) -> bool:
    """Record success with two outputs."""
    return jobs.finish(
        job.id,
        job.lease_token,
        verdict="simulation_ready",
        summary="3 shells",
        outputs={"package": PACKAGE, "report": REPORT},
        timings_s={"shells: fat": 1.5},
        peak_memory_bytes=1_000_000,
    )
