"""The tree of everything this client raises on purpose.

IntegumentError
├── ArgumentError               what was handed in makes no sense; nothing was sent
├── ServerError                 the talk with the server went wrong
│   ├── ServerUnreachableError  no (complete) answer, even after the retries
│   ├── ProblemError            it refused, with a stable `code` and a sentence (RFC 9457)
│   └── ReplyError              it answered something this client cannot read
├── JobError                    the job ended without doing what it promises; carries `job`
│   ├── JobFailedError
│   └── JobDismissedError
├── WaitTimeoutError            the job is not done yet; it goes on
├── DownloadCorruptError        the bytes do not have the SHA-256 the server states
└── EmbeddedServerError         the server for this call
    ├── ServerNotInstalledError
    └── ServerStartError
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from integument.job import Job
    from integument.problem import Problem

TRANSIENT_STATUSES = frozenset({429, 502, 503, 504})
UNTOUCHED_STATUSES = frozenset({429, 503})  # the server says it did not begin the work
STILL_AT_IT = frozenset({"idempotency.in_flight", "upload.busy"})  # our own earlier try is still being answered


class IntegumentError(Exception):
    """Root of all errors of this client."""


class ArgumentError(IntegumentError):
    """An argument or a local file is at fault; nothing was sent."""


class ServerError(IntegumentError):
    """The talk with the server went wrong."""

    transient = False
    """True if the same request may succeed a little later."""
    untouched = False
    """True if the server certainly did nothing, so even a request that must not happen twice may be sent again."""
    retry_after_s: float | None = None


class ServerUnreachableError(ServerError):
    """No complete answer came."""

    transient = True

    def __init__(self, url: str, reason: str, *, untouched: bool) -> None:
        super().__init__(f"no answer from {url}: {reason}")
        self.url = url
        self.untouched = untouched


class ProblemError(ServerError):
    """The server refused and said why."""

    def __init__(self, problem: Problem, *, retry_after_s: float | None = None) -> None:
        super().__init__(f"{problem.code}: {problem.detail or problem.title}")
        self.problem = problem
        self.status = problem.status
        self.code = problem.code
        self.detail = problem.detail
        self.transient = problem.status in TRANSIENT_STATUSES or problem.code in STILL_AT_IT
        self.untouched = problem.status in UNTOUCHED_STATUSES
        self.retry_after_s = retry_after_s


class ReplyError(ServerError):
    """The answer is not what this client understands: another kind of server, or another version."""


class JobError(IntegumentError):
    """The job ended without doing what it promises."""

    def __init__(self, job: Job, message: str) -> None:
        super().__init__(message)
        self.job = job


class JobFailedError(JobError):
    """`job.failure` says whose fault it is and whether a retry may help; the job has a report all the same."""

    def __init__(self, job: Job) -> None:
        why = f"{job.failure.code}: {job.failure.message}" if job.failure else job.message or "no reason given"
        super().__init__(job, f"job {job.id} failed: {why}")


class JobDismissedError(JobError):
    """Somebody cancelled the job."""

    def __init__(self, job: Job) -> None:
        super().__init__(job, f"job {job.id} was dismissed")


class WaitTimeoutError(IntegumentError):
    """The job is not done yet; it goes on."""

    def __init__(self, job_id: str, timeout_s: float) -> None:
        super().__init__(f"job {job_id} is not done after {timeout_s:g} s; it goes on")
        self.job_id = job_id


class DownloadCorruptError(IntegumentError):
    """The bytes that arrived do not have the SHA-256 the server states; nothing was left at the target."""

    def __init__(self, what: str, expected_sha256: str, got_sha256: str) -> None:
        super().__init__(f"{what} arrived with SHA-256 {got_sha256}, the server states {expected_sha256}")
        self.expected_sha256 = expected_sha256
        self.got_sha256 = got_sha256


class EmbeddedServerError(IntegumentError):
    """The server for this call could not be had."""


class ServerNotInstalledError(EmbeddedServerError):
    """Only the client is installed here."""

    def __init__(self) -> None:
        super().__init__(
            "the server is not installed beside this client; install it with `pip install .` in a clone of the repository, "
            "or name a running one with --server or INTEGUMENT_URL"
        )


class ServerStartError(EmbeddedServerError):
    """The server ended, or was not ready in time; the message holds the end of its log."""
