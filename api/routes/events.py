"""What happens to a job, as it happens (Server-Sent Events)."""

from __future__ import annotations

import logging
import time
from collections.abc import AsyncIterator, Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query
from fastapi.sse import EventSourceResponse, ServerSentEvent
from starlette.concurrency import run_in_threadpool

from api.access import Access, AccessDep
from api.parameters import JobId
from api.responses import problems
from api.services import Services, ServicesDep
from core.errors import InternalError
from store.events import Event

logger = logging.getLogger(__name__)

router = APIRouter(prefix="/jobs/{job_id}", tags=["Jobs"])

RETRY_MS = 3000
DONE = "done"
STILL_THERE_S = 2.0  # how often a silent stream makes sure that whoever listens is still let in
BATCH = 500
LARGEST_SEQ = 2**31 - 1

LastEventId = Annotated[
    int | None, Header(alias="Last-Event-ID", ge=0, le=LARGEST_SEQ, description="Number of the last event seen; go on after it")
]
After = Annotated[int | None, Query(ge=0, le=LARGEST_SEQ, description="The same, for clients that cannot set the header")]


@dataclass(frozen=True, slots=True)
class _Stream:
    """A slot that is taken, and where to begin."""

    access: Access
    job_id: str
    after: int


def _open_stream(
    job_id: JobId,
    services: ServicesDep,
    access: AccessDep,
    last_event_id: LastEventId = None,
    after: After = None,
) -> Iterator[_Stream]:
    """Everything that can be refused is refused before the stream begins."""
    services.jobs.get(access.workspace, job_id)
    with services.streams.take():
        yield _Stream(access, job_id, last_event_id if last_event_id is not None else after or 0)


@router.get(
    "/events",
    operation_id="streamEvents",
    response_class=EventSourceResponse,
    responses={
        200: {
            "description": "`status`, `progress`, `log` and last `done`, with JSON data; the id of an event is its number",
            "content": {"text/event-stream": {"schema": {"type": "string"}}},
        },
        **problems(404, 422, 503),
    },
)
async def stream_events(
    stream: Annotated[_Stream, Depends(_open_stream)], services: ServicesDep
) -> AsyncIterator[ServerSentEvent]:
    """The events of a job from the first, or after the last one seen. The stream ends with `done`."""
    yield ServerSentEvent(retry=RETRY_MS, comment="events of a job")
    try:
        async for told in _events_of(stream, services):
            yield told
    except InternalError as error:
        if error.code != "database.unavailable":
            raise
        # the head was sent long ago; whoever listens comes back to where he was
        logger.warning("the events of job %s break off: %s", stream.job_id, error)


async def _events_of(stream: _Stream, services: Services) -> AsyncIterator[ServerSentEvent]:
    seen, looked_at = stream.after, time.monotonic()
    with services.watch.watching(stream.job_id) as job:
        while not services.drain.begun:
            events = await run_in_threadpool(services.events.after, stream.access.workspace, stream.job_id, seen, BATCH)
            for event in events:
                last = event.type == DONE and await run_in_threadpool(_is_last, services, event)
                yield _sent(event, last)
                seen = event.seq
                if last:
                    return
            if events:
                continue
            await job.news(seen, STILL_THERE_S)
            is_over = job.head is None or (job.head.finished and job.head.seq <= seen)
            if is_over and await run_in_threadpool(_has_ended, services, stream, seen):
                return
            if time.monotonic() - looked_at > STILL_THERE_S:
                looked_at = time.monotonic()
                if not await run_in_threadpool(services.admission.holds, stream.access):
                    return


def _sent(event: Event, last: bool) -> ServerSentEvent:
    """`done` closes a stream on both sides; where a retry followed, it was only one status among others."""
    kind = "status" if event.type == DONE and not last else event.type
    data: dict[str, Any] = {**event.data, "at": event.at.isoformat()}
    return ServerSentEvent(event=kind, id=str(event.seq), data=data)


def _is_last(services: Services, event: Event) -> bool:
    head = services.heads.of((event.job_id,)).get(event.job_id)
    return head is None or head.seq == event.seq  # None: removed just now


def _has_ended(services: Services, stream: _Stream, seen: int) -> bool:
    """True if the job is gone, or over and all its events were seen before; asked again, since it may have been retried."""
    head = services.heads.of((stream.job_id,)).get(stream.job_id)
    return head is None or (head.finished and head.seq <= seen)
