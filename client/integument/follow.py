"""Watching a job through every broken connection."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator

import httpx

from integument.errors import ReplyError, ServerError, ServerUnreachableError
from integument.event import JobEvent
from integument.event_stream import EventStreamParser, Message
from integument.job import Job
from integument.transport import Transport

DONE = "done"
SILENCE_S = 45.0  # the server sends a sign of life every 15 s
# what happened already is sent at once; so long a pause means that the past has ended
PAST_SILENCE_S = 1.0
PAST_LIMIT_S = 3.0
LOST_AFTER_S = 60.0  # a server that restarts in the meantime goes on with the job


def follow_events(transport: Transport, job_id: str, *, look: Callable[[], Job], after: str = "") -> Iterator[JobEvent]:
    """The job's events after number `after` up to its end, each once, in order.

    A broken or silent connection is replaced and the server told the last number seen; a server that is gone is waited
    for a minute. Between two connections `look` asks for the job itself, which ends the watch when the job is over and a
    last connection brought nothing new (a proxy that holds events back). A `done` that a retry has overtaken is not the end.

    Raises: ProblemError (the job does not exist), ServerUnreachableError, ReplyError.
    """
    last_id, retry_s = after, transport.first_pause_s
    was_done, alive_at = False, time.monotonic()
    while True:
        parser = EventStreamParser(last_id)
        try:
            for event in _one_connection(transport, job_id, parser, SILENCE_S):
                yield event
                alive_at = time.monotonic()
                if event.type == DONE and _is_end(event, look()):
                    return
        except ServerError as error:
            if not error.transient:
                raise
        if was_done and parser.last_id == last_id:
            return
        try:
            was_done, alive_at = look().done, time.monotonic()
        except ServerError as error:
            if not error.transient or time.monotonic() - alive_at > LOST_AFTER_S:
                raise
        last_id, retry_s = parser.last_id, retry_s if parser.retry_s is None else parser.retry_s
        time.sleep(retry_s)


def past_events(transport: Transport, job_id: str, *, after: str = "") -> Iterator[JobEvent]:
    """The events there are now, without waiting for more.

    Raises: ProblemError (the job does not exist), ServerUnreachableError, ReplyError.
    """
    deadline = time.monotonic() + PAST_LIMIT_S
    try:
        for event in _one_connection(transport, job_id, EventStreamParser(after), PAST_SILENCE_S):
            yield event
            if time.monotonic() > deadline:
                return
    except ServerUnreachableError as error:
        if not isinstance(error.__cause__, httpx.ReadTimeout):
            raise


def _is_end(done: JobEvent, job: Job) -> bool:
    return job.done and int(done.data.get("attempt", job.attempt)) >= job.attempt


def _one_connection(transport: Transport, job_id: str, parser: EventStreamParser, silence_s: float) -> Iterator[JobEvent]:
    headers = {"Accept": "text/event-stream", "Cache-Control": "no-store"}
    if parser.last_id:
        headers["Last-Event-ID"] = parser.last_id
    with transport.stream("GET", f"/v1/jobs/{job_id}/events", headers=headers, read_timeout_s=silence_s) as response:
        for piece in response.iter_bytes():
            for message in parser.feed(piece):
                yield _read(message)


def _read(message: Message) -> JobEvent:
    try:
        data = json.loads(message.data)
    except ValueError as error:
        raise ReplyError(f"event {message.id} of the job is no JSON: {message.data[:100]}") from error
    if not isinstance(data, dict):
        raise ReplyError(f"event {message.id} of the job is no JSON object: {message.data[:100]}")
    return JobEvent(message.id, message.type, data)
