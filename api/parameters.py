"""Parameters several routes share."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Annotated

from fastapi import Depends, Header, Path, Query, Request

from api.preferences import Preferences, read_preferences
from core.errors import StateError

_UUID = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")


async def job_id_of(job_id: Annotated[str, Path(description="Id of a job")]) -> str:
    """What cannot be an id is not looked for. Raises StateError `job.not_found`."""
    if not _UUID.fullmatch(job_id):
        raise StateError("job.not_found", f"there is no job {job_id[:100]!r}")
    return job_id


async def mesh_id_of(mesh_id: Annotated[str, Path(description="Id of a mesh")]) -> str:
    """What cannot be an id is not looked for. Raises StateError `mesh.not_found`."""
    if not _UUID.fullmatch(mesh_id):
        raise StateError("mesh.not_found", f"there is no mesh {mesh_id[:100]!r}")
    return mesh_id


async def upload_id_of(upload_id: Annotated[str, Path(description="Id of an upload")]) -> str:
    """What cannot be an id is not looked for. Raises StateError `upload.not_found`."""
    if not _UUID.fullmatch(upload_id):
        raise StateError("upload.not_found", f"there is no upload {upload_id[:100]!r}")
    return upload_id


async def cohort_id_of(cohort_id: Annotated[str, Path(description="Id of a cohort")]) -> str:
    """What cannot be an id is not looked for. Raises StateError `cohort.not_found`."""
    if not _UUID.fullmatch(cohort_id):
        raise StateError("cohort.not_found", f"there is no cohort {cohort_id[:100]!r}")
    return cohort_id


async def preferences_of(
    request: Request,
    prefer: Annotated[
        str | None, Header(description="RFC 7240: `wait=N` (seconds, up to 30) holds the answer back; `respond-async`")
    ] = None,
) -> Preferences:
    """All `Prefer` lines, not only the first."""
    return read_preferences(request.headers.getlist("prefer"))


def split_commas(sent: Sequence[str] | str) -> list[str]:
    """`a=x&a=y` and `a=x,y` mean the same: OGC writes the latter, most clients the former."""
    lines = [sent] if isinstance(sent, str) else sent
    return [word for line in lines for word in line.split(",") if word]


JobId = Annotated[str, Depends(job_id_of)]
CohortId = Annotated[str, Depends(cohort_id_of)]
MeshId = Annotated[str, Depends(mesh_id_of)]
UploadId = Annotated[str, Depends(upload_id_of)]
PreferencesDep = Annotated[Preferences, Depends(preferences_of)]
IdempotencyKey = Annotated[
    str | None, Header(alias="Idempotency-Key", description="Same key and request: done once, answered alike, for 24 h")
]
KeepEnded = Annotated[bool, Query(description="Only take back what is live: what has ended meanwhile stays, with its results")]
MostFaces = Annotated[
    int | None,
    Query(
        ge=1_000,
        le=100_000_000,
        description="Above so many faces a coarser mesh for the eye alone: it may be open and cut itself. Not of `original`",
    ),
]
PageLimit = Annotated[int, Query(ge=1, le=1000, description="Entries per page")]
TextFilter = Annotated[
    str, Query(max_length=200, description="Only those in whose names every word of this occurs; upper and lower case are alike")
]
Cursor = Annotated[str | None, Query(pattern=r"^[A-Za-z0-9_-]{1,200}$", description="`next` of the page before")]
