"""What is counted for as long as the tables exist; docs/operations.md lists the same names, and a test compares.

No label ever holds an id, a file name or anything else users choose: every label has few values, and a family that gets too many
all the same, because a child made up names of stages, puts the rest under `other`."""

from __future__ import annotations

from dataclasses import dataclass

MAX_SERIES = 400  # of one family
OTHER = "other"


@dataclass(frozen=True, slots=True)
class Family:
    """A counter, or with `buckets` (their upper bounds, rising) a histogram."""

    name: str
    text: str
    labels: tuple[str, ...] = ()
    buckets: tuple[float, ...] = ()


SHORT_S = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)
LONG_S = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
FACES = (1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6, 3e6, 1e7)
MEMORY_BYTES = tuple(float(2**power) for power in range(27, 37))  # 128 MiB to 64 GiB

JOB_ATTEMPTS = Family("integument_job_attempts_total", "Attempts begun by a worker.", ("process",))
JOBS_ENDED = Family("integument_jobs_ended_total", "Jobs that came to an end.", ("process", "status"))
JOB_FAILURES = Family("integument_job_failures_total", "Failed jobs by the code of their failure.", ("process", "code"))
LEASES_EXPIRED = Family("integument_leases_expired_total", "Attempts whose worker fell silent.", ("process",))
JOB_WAIT_S = Family("integument_job_wait_seconds", "From being queued to the beginning of an attempt.", ("process",), LONG_S)
JOB_RUN_S = Family("integument_job_run_seconds", "The last attempt of an ended job, from claim to end.", ("process",), LONG_S)
STAGE_S = Family("integument_stage_seconds", "Stages of ended jobs.", ("process", "stage"), LONG_S)
JOB_FACES = Family("integument_job_input_faces", "Faces of all meshes an ended job read.", ("process",), FACES)
JOB_PEAK_BYTES = Family(
    "integument_job_peak_memory_bytes", "Largest resident memory of an ended job's child.", ("process",), MEMORY_BYTES
)
CALLBACKS_ENDED = Family("integument_callbacks_ended_total", "Callbacks delivered, or given up (dead).", ("state",))
HTTP_REQUESTS = Family("integument_http_requests_total", "Answered requests.", ("method", "route", "status"))
HTTP_S = Family("integument_http_request_seconds", "From a request to the beginning of its answer.", ("method", "route"), SHORT_S)
REFUSALS = Family("integument_requests_refused_total", "Requests turned away before any route, by the problem's code.", ("code",))

FAMILIES = {
    family.name: family
    for family in (
        *(JOB_ATTEMPTS, JOBS_ENDED, JOB_FAILURES, LEASES_EXPIRED, JOB_WAIT_S, JOB_RUN_S, STAGE_S, JOB_FACES, JOB_PEAK_BYTES),
        *(CALLBACKS_ENDED, HTTP_REQUESTS, HTTP_S, REFUSALS),
    )
}
