"""The body of a callback: OGC's statusInfo of a job, thin. Everything else is behind its links."""

from __future__ import annotations

import json
import math
from datetime import datetime
from typing import Any

from store.job import JobStatus
from store.records import JobRow

MAX_WORDS = 1_000  # characters of each of the three texts: 20 kB are not reached whatever the alphabet
RESULTS_RELATION = "http://www.opengis.net/def/rel/ogc/1.0/results"


def status_info(row: JobRow, base_url: str) -> str:
    """JSON, below 20 kB. Its members are those of `GET /v1/jobs/{id}`; null ones are left out."""
    path = f"{base_url.rstrip('/')}/v1/jobs/{row.id}"
    links = [{"href": path, "rel": "self", "type": "application/json", "title": "Status"}]
    if row.outputs:
        links.append({"href": f"{path}/results", "rel": RESULTS_RELATION, "type": "application/json", "title": "Results"})
    told: dict[str, Any] = {
        "type": "process",
        "jobID": row.id,
        "processID": row.process,
        "status": JobStatus(row.status).value,
        "message": _cut(row.message),
        "progress": math.floor(row.progress),
        "created": _instant(row.created_at),
        "started": _instant(row.started_at),
        "finished": _instant(row.finished_at),
        "updated": _instant(row.updated_at),
        "attempt": row.attempt,
        "queue": row.queue,
        "expectedMemoryBytes": row.expected_memory_bytes,
        "verdict": row.verdict,
        "summary": None if row.summary is None else _cut(row.summary),
        "failure": _failure(row.failure),
        "links": links,
    }
    return json.dumps({key: value for key, value in told.items() if value is not None}, ensure_ascii=False, allow_nan=False)


def _failure(told: dict[str, Any] | None) -> dict[str, Any] | None:
    """Without facts and findings, which know no limit."""
    if told is None:
        return None
    return {"code": told["code"], "class": told["class"], "message": _cut(told["message"]), "retryable": told["retryable"]}


def _instant(moment: datetime | None) -> str | None:
    return None if moment is None else moment.isoformat().replace("+00:00", "Z")


def _cut(text: str) -> str:
    return text if len(text) <= MAX_WORDS else text[: MAX_WORDS - 1] + "…"
