"""A callback: what a subscriber asked to be told of a job, and how far the telling is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from store.workspace import WorkspaceId


class CallbackEvent(StrEnum):
    """What happened; OGC's `subscriber` has an address for each."""

    IN_PROGRESS = "inProgress"  # an attempt started
    SUCCESS = "success"
    FAILED = "failed"
    DISMISSED = "dismissed"  # goes where failures go: OGC has no address for it, and a pipeline waits for an end


class CallbackState(StrEnum):
    """Of the telling, not of the job."""

    PENDING = "pending"
    DELIVERED = "delivered"  # answered by 2xx
    DEAD = "dead"  # given up: too many attempts, or answered by 410


@dataclass(frozen=True, slots=True)
class Subscriber:
    """Where to send what happens; `base_url` is this server's as the subscriber knows it, for the links of the body."""

    base_url: str
    success_uri: str
    in_progress_uri: str | None = None
    failed_uri: str | None = None

    def uri_of(self, event: CallbackEvent) -> str | None:
        """None: nothing is to be told."""
        return {
            CallbackEvent.SUCCESS: self.success_uri,
            CallbackEvent.IN_PROGRESS: self.in_progress_uri,
            CallbackEvent.FAILED: self.failed_uri,
            CallbackEvent.DISMISSED: self.failed_uri,
        }[event]

    def describe(self) -> dict[str, str | None]:
        """JSON for the row of the job."""
        return {name: getattr(self, name) for name in self.__slots__}

    @classmethod
    def read(cls, told: Mapping[str, str | None]) -> Subscriber:
        """The inverse of `describe`."""
        return cls(str(told["base_url"]), str(told["success_uri"]), told["in_progress_uri"], told["failed_uri"])


@dataclass(frozen=True, slots=True)
class Callback:
    """A snapshot. `body` is sent as it stands, with the same `id`, in every attempt; `attempts` counts those begun."""

    id: str
    workspace: WorkspaceId
    job_id: str
    event: CallbackEvent
    uri: str
    body: str
    state: CallbackState
    attempts: int
    lease_token: int
    created_at: datetime
    due_at: datetime
    ended_at: datetime | None
    last_status: int | None
    last_error: str | None
