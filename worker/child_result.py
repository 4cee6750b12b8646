"""What a child hands over when it is done; the child has read untrusted files, so nothing it says is taken on trust."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, StringConstraints, ValidationError

from core.errors import InternalError
from core.schema.report import Verdict
from sandbox.handed_file import require_own_file
from sandbox.outcome import protocol_broken
from store.blobs import Blobs
from store.job import JobOutput

OutputName = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}$")]
MediaType = Annotated[
    str, StringConstraints(pattern=r"^[a-z0-9.+-]+/[a-z0-9.+-]+(; ?[a-z0-9-]+=[A-Za-z0-9.-]+)*$", max_length=128)
]
FileName = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_. -]{0,127}$")]


class ListedOutput(BaseModel):
    """One file the child says it wrote."""

    model_config = ConfigDict(frozen=True)

    name: OutputName
    path: str
    media_type: MediaType
    file_name: FileName


class ChildResult(BaseModel):
    """The return value of core.processes.registry.run."""

    model_config = ConfigDict(frozen=True)

    verdict: Verdict
    summary: Annotated[str, StringConstraints(max_length=10_000)]
    outputs: tuple[ListedOutput, ...]


def read_result(result: Mapping[str, Any]) -> ChildResult:
    """Raises InternalError `child.protocol_broken`."""
    try:
        return ChildResult.model_validate(result)
    except ValidationError as error:
        raise _broken(error) from error


def read_outputs(listed: Iterable[Mapping[str, Any]]) -> tuple[ListedOutput, ...]:
    """The files that came with an error. Raises InternalError `child.protocol_broken`."""
    try:
        return tuple(ListedOutput.model_validate(output) for output in listed)
    except ValidationError as error:
        raise _broken(error) from error


def store_outputs(outputs: Iterable[ListedOutput], folder: Path, blobs: Blobs) -> dict[str, JobOutput]:
    """Put the files into the blobs. The child must be dead, so that nobody exchanges them meanwhile.

    Raises InternalError `child.protocol_broken` for anything but plain files inside `folder`; LimitError `storage.full`."""
    kept: dict[str, JobOutput] = {}
    for output in outputs:
        if output.name in kept:
            raise protocol_broken(f"output {output.name} is named twice")
        path = require_own_file(folder, output.path, f"output {output.name}")
        blob = blobs.put_file(path)
        kept[output.name] = JobOutput(blob.sha256, blob.size, output.media_type, output.file_name)
    return kept


def _broken(error: ValidationError) -> InternalError:
    where = "; ".join(f"{'.'.join(map(str, problem['loc']))}: {problem['msg']}" for problem in error.errors()[:3])
    return protocol_broken(where)
