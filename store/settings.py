"""Settings: environment variables `INTEGUMENT_*`, checked once at start and never changed (docs/settings.md)."""

from __future__ import annotations

import difflib
import os
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, ByteSize, Field, model_validator
from pydantic_settings import BaseSettings, NoDecode, SettingsConfigDict
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError

from core.schema.expectation import JobQueue
from store.callback_secret import secret_bytes
from store.host_memory import budget_bytes
from store.receivers import Receivers
from store.s3_place import S3Place

PREFIX = "INTEGUMENT_"
CLIENT_VARIABLES = frozenset({"INTEGUMENT_URL", "INTEGUMENT_API_KEY"})
"""Read by the client alone; a server beside it lets them pass."""

DATABASE_SCHEMES = ("sqlite", "postgresql", "postgresql+psycopg")
BROKER_SCHEMES = ("redis", "rediss", "redis+socket")
GIB = 1024**3


def default_data_dir() -> Path:
    """`$XDG_DATA_HOME/integument`, or `~/.local/share/integument`."""
    home = os.environ.get("XDG_DATA_HOME", "")
    return (Path(home) if home else Path.home() / ".local" / "share") / "integument"


def _absolute(path: Path) -> Path:
    return path.expanduser().absolute()


def _database_url(url: str) -> str:
    scheme = url.partition("://")[0]
    if scheme not in DATABASE_SCHEMES:
        raise ValueError(f"database URL starts with '{scheme}://', known are {', '.join(DATABASE_SCHEMES)}")
    try:
        parsed = make_url(url)
    except ArgumentError:
        raise ValueError("database URL cannot be read") from None
    if scheme == "sqlite" and parsed.database in (None, "", ":memory:"):
        raise ValueError("a SQLite database URL must name a file: API and worker are two processes")
    return url


def _broker_url(url: str) -> str:
    scheme, _, rest = url.partition("://")
    if scheme not in BROKER_SCHEMES or not rest:
        raise ValueError(f"broker URL starts with '{scheme}://', known are {', '.join(BROKER_SCHEMES)}")
    return url


def _blobs_url(url: str) -> str:
    if url:
        S3Place.of(url)
    return url


def _names(value: Any) -> Any:
    """`a.example, B.example` -> ("a.example", "b.example")."""
    names = value.split(",") if isinstance(value, str) else value
    return tuple(str(name).strip().lower() for name in names if str(name).strip())


def _secrets(value: Any) -> Any:
    """Separated by commas; base64 knows upper and lower case."""
    secrets = value.split(",") if isinstance(value, str) else value
    return tuple(str(secret).strip() for secret in secrets if str(secret).strip())


def _checked_secrets(secrets: tuple[str, ...]) -> tuple[str, ...]:
    for secret in secrets:
        secret_bytes(secret)
    return secrets


def _checked_receivers(names: tuple[str, ...]) -> tuple[str, ...]:
    Receivers(names)
    return names


def _to_text(value: Any) -> str:
    return ",".join(value) if isinstance(value, tuple) else str(value)


Size = Annotated[ByteSize, Field(gt=0)]
Seconds = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Days = Annotated[float, Field(ge=0, le=36_500, allow_inf_nan=False)]


class Settings(BaseSettings):
    """All there is to set. Sizes read `2GiB` as well as numbers of bytes; times are seconds."""

    model_config = SettingsConfigDict(
        env_prefix=PREFIX, frozen=True, extra="forbid", hide_input_in_errors=True, validate_default=True
    )

    data_dir: Annotated[Path, AfterValidator(_absolute)] = Field(
        default_factory=default_data_dir, description="Folder of blobs, scratch space and, by default, the database"
    )
    database_url: Annotated[str, AfterValidator(_database_url)] = Field(
        default_factory=lambda data: f"sqlite:///{data['data_dir']}/integument.sqlite3",
        repr=False,
        description="`sqlite:///file` or `postgresql://user:password@host/name`",
    )
    broker_url: Annotated[str, AfterValidator(_broker_url)] = Field(
        "redis://127.0.0.1:6379/0", repr=False, description="Redis or Valkey: `redis://`, `rediss://`, `redis+socket:///path`"
    )
    blobs_url: Annotated[str, AfterValidator(_blobs_url)] = Field(
        "",
        repr=False,
        description="Object store for all files: `s3+https://key:secret@host/bucket/folder`; empty: a folder in the data folder",
    )
    blobs_links_s: float = Field(
        0.0,
        ge=0,
        le=604_800,
        description="Downloads are sent on to the object store by links that hold this long; 0: not at all",
    )
    queue: str = Field("jobs", pattern=r"^[a-z][a-z0-9_.-]{0,63}$", description="Name of the queue API and workers share")
    host: str = Field("127.0.0.1", min_length=1, description="Address the API binds")
    port: int = Field(8000, ge=0, le=65535, description="Port the API binds; 0 picks a free one")
    require_keys: Literal["auto", "true"] = Field(
        "auto", description="`auto`: API keys are asked for once one was made; `true`: always, so set it behind a proxy"
    )
    rate_per_s: float = Field(
        100.0, ge=0, allow_inf_nan=False, description="Requests per second of one workspace's keys in the long run; 0: no limit"
    )
    rate_burst: int = Field(400, ge=1, description="Requests such a workspace may send at once before that rate holds")
    quota_bytes: ByteSize = Field(
        ByteSize(0), ge=0, description="Bytes one workspace may store, uploads and results; 0: no limit"
    )
    quota_jobs: int = Field(1000, ge=0, description="Jobs of one workspace that may wait and run at a time; 0: no limit")
    cohort_subjects: int = Field(500, ge=1, le=10_000, description="Subjects one cohort may have; every one is a job of its own")
    allowed_hosts: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_names)] = Field(
        (), description="Host names requests may carry besides loopback ones, separated by commas; `*` for any"
    )
    connections: int = Field(2000, ge=0, le=1_000_000, description="Connections one API process keeps open; 0: no limit")
    connections_per_address: int = Field(
        1000, ge=0, le=1_000_000, description="Of these from one address (IPv6: one network of 64 bits); 0: no limit, for a proxy"
    )
    event_streams: int = Field(200, ge=1, le=10_000, description="Event streams the API keeps open at once")
    upload_limit_bytes: Size = Field(ByteSize(2 * GIB), description="Largest file of one upload")
    upload_hours: float = Field(
        24.0, gt=0, allow_inf_nan=False, description="How long an upload in pieces is kept after its last piece"
    )
    intake_memory_bytes: Size = Field(ByteSize(4 * GIB), description="Address space of the child that reads an upload")
    intake_wall_s: Seconds = Field(120.0, description="Time the child has to read an upload")
    job_memory_bytes: Size = Field(ByteSize(8 * GIB), description="Memory of one job's child process")
    job_cpu_s: Seconds = Field(3600.0, description="CPU time of one attempt")
    job_wall_s: Seconds = Field(3600.0, description="Wall time of one attempt")
    job_file_bytes: Size = Field(ByteSize(8 * GIB), description="Largest file a job may write")
    preview_bytes: ByteSize = Field(
        ByteSize(GIB // 2), ge=0, description="Coarser meshes for the eye that one API host keeps, those looked at last; 0: none"
    )
    require_confinement: bool = Field(
        False,
        description="`true`: API and worker refuse to start, and children to work, where the kernel cannot lock a child in "
        "(Landlock, filter of system calls)",
    )
    checkpoint_bytes: ByteSize = Field(
        ByteSize(2 * GIB), ge=0, description="Outputs of finished steps kept for the next attempt of one job; 0: none"
    )
    checkpoint_after_s: float = Field(
        1.0, ge=0, allow_inf_nan=False, description="Steps that took less processor time are not kept"
    )
    checkpoint_days: float = Field(
        7.0, gt=0, allow_inf_nan=False, description="How long the steps of a failed job are kept, for it to be retried"
    )
    lease_s: Seconds = Field(30.0, description="A worker silent for this long has lost its job")
    heartbeat_s: Seconds = Field(1.0, description="How often a worker renews its lease and looks for a dismissal")
    drain_s: Seconds = Field(30.0, description="How long the jobs of a worker that is told to stop may still run")
    reconcile_s: Seconds = Field(5.0, description="How often lost leases and unanswered rings are looked for")
    rering_s: Seconds = Field(30.0, description="An accepted job nobody took is announced again after this long")
    max_attempts: int = Field(
        2, ge=1, le=100, description="Workers a job may lose before it fails with `worker.lost`; two more for `prepare`"
    )
    worker_concurrency: int = Field(
        default_factory=lambda: len(os.sched_getaffinity(0)), ge=1, le=1024, description="Jobs one worker runs at a time"
    )
    worker_fast_slots: int = Field(
        1, ge=0, le=1024, description="Fast jobs a worker runs beyond that while heavy ones have all its slots"
    )
    worker_queues: Annotated[tuple[JobQueue, ...], NoDecode, BeforeValidator(_names), Field(min_length=1)] = Field(
        tuple(JobQueue), description="Which jobs a worker takes: `fast`, `heavy` or both, separated by commas"
    )
    worker_memory_bytes: Size = Field(
        default_factory=lambda: ByteSize(budget_bytes()),
        description="What all jobs on one worker host may need together; a job that does not fit waits for another host",
    )
    look_s: Seconds = Field(1.0, description="How often a worker with room looks for jobs although nobody rang")
    memory_patience_s: Seconds = Field(
        60.0, description="After this wait, a job that only lacks memory holds back others until it fits"
    )
    host_wait_s: Seconds = Field(
        3600.0, description="How long a job waits for a host large enough before it fails with `job.too_large_for_memory`"
    )
    callback_secret: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_secrets), AfterValidator(_checked_secrets)] = Field(
        (),
        repr=False,
        description="Signs callbacks: `whsec_` and base64 of 24 to 64 bytes; several, separated by commas, while one replaces "
        "another; none: callbacks are refused",
    )
    callback_allow: Annotated[tuple[str, ...], NoDecode, BeforeValidator(_names), AfterValidator(_checked_receivers)] = Field(
        (), description="Host names, addresses and networks callbacks may go to besides the public internet, also by http"
    )
    event_poll_s: Seconds = Field(0.1, description="How often the API looks for news of jobs, once for all who wait for some")
    log_format: Literal["auto", "json", "text"] = Field(
        "auto", description="Lines of the logs: `json`, `text`, or `auto`: text on a terminal, JSON elsewhere"
    )
    keep_jobs_days: Days = Field(0.0, description="Jobs that ended longer ago are removed with their results; 0: never")
    keep_meshes_days: Days = Field(
        0.0, description="Uploads older than that are removed unless a job there is reads them; 0: never"
    )
    keep_events_days: Days = Field(
        0.0, description="Progress and log lines of jobs that ended longer ago are removed; 0: with the job"
    )
    disk_floor_bytes: ByteSize = Field(
        ByteSize(GIB // 4),
        ge=0,
        description="With less free on the disk of the data folder, the API refuses new work by `storage.low` and a worker takes "
        "no job",
    )
    parked_days: float = Field(
        365.0, gt=0, allow_inf_nan=False, description="How long a parked request is refused; then it may be tried again"
    )
    audit_days: float = Field(365.0, gt=0, allow_inf_nan=False, description="How long the audit log is kept")
    idempotency_hours: float = Field(24.0, gt=0, allow_inf_nan=False, description="How long an Idempotency-Key is remembered")

    @model_validator(mode="after")
    def _heartbeat_within_lease(self) -> Self:
        if self.heartbeat_s * 3 > self.lease_s:
            raise ValueError(f"heartbeat_s {self.heartbeat_s} must be at most a third of lease_s {self.lease_s}")
        return self

    @model_validator(mode="before")
    @classmethod
    def _no_unknown_variables(cls, values: Any) -> Any:
        """A misspelt variable would otherwise be ignored in silence."""
        known = {PREFIX + name.upper() for name in cls.model_fields} | CLIENT_VARIABLES
        for name in os.environ:
            if name.upper().startswith(PREFIX) and name.upper() not in known:
                near = difflib.get_close_matches(name.upper(), known, n=1)
                raise ValueError(f"no setting is called {name}" + (f"; did you mean {near[0]}?" if near else ""))
        return values

    @property
    def sqlite_path(self) -> Path | None:
        """The file of a SQLite database; None for a server."""
        url = make_url(self.database_url)
        return Path(str(url.database)) if url.get_backend_name() == "sqlite" else None

    @property
    def blob_dir(self) -> Path:
        """Where content-addressed files live."""
        return self.data_dir / "blobs"

    @property
    def scratch_dir(self) -> Path:
        """Uploads on their way in and the working folders of jobs; on the same disk as the blobs, so moving is renaming."""
        return self.data_dir / "scratch"

    def as_environment(self) -> dict[str, str]:
        """The variables that make another process read these very settings."""
        return {PREFIX + name.upper(): _to_text(getattr(self, name)) for name in type(self).model_fields}
