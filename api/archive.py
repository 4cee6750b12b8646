"""From an archive to meshes the server holds: each file read in a limited child of its own, so a broken one spoils no other."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.intake import limits_of, parse
from api.request_folder import request_folder
from api.services import Services
from api.upload_form import ReceivedFile
from core.errors import IntegumentError
from sandbox.call import call
from sandbox.handed_file import require_own_file
from store.cohort import RefusedSubject
from store.meshes import MeshRecord
from store.workspace import WorkspaceId

TARGET = "core.processes.unpack:run"
NOT_THE_FILE = frozenset({"storage.full", "nursery.lost", "nursery.fork_failed", "blobs.unavailable", "database.unavailable"})


@dataclass(frozen=True, slots=True)
class TakenArchive:
    """meshes: (name of the subject, mesh). `ignored` are names of files that are no meshes."""

    meshes: tuple[tuple[str, MeshRecord], ...]
    refused: tuple[RefusedSubject, ...]
    ignored: tuple[str, ...]


@contextmanager
def take_archive(
    services: Services,
    workspace: WorkspaceId,
    received: ReceivedFile,
    unit: str,
    folder: Path,
    *,
    volumes: bool,
    reserved_bytes: int = 0,
) -> Iterator[TakenArchive]:
    """Meshes, or label `volumes` in their place. `folder` is scratch space. What was taken is kept if the block ends well;
    whatever stops it, here or there, nothing is. reserved_bytes: of the quota, that the archive itself takes until then.

    Raises what `core.processes.unpack` raises, LimitError `limit.*`, `quota.bytes`, `storage.full`, InternalError `child.*`."""
    told = _unpack(services, received, folder, volumes=volumes)
    meshes: list[tuple[str, MeshRecord]] = []
    refused: list[RefusedSubject] = []
    try:
        for entry in told["files"]:
            name, file_name = str(entry["name"]), str(entry["file_name"])
            if "code" in entry:
                refused.append(RefusedSubject(name, str(entry["code"]), str(entry["message"])))
                continue
            path = require_own_file(folder, str(entry["path"]), f"'{file_name}'")
            file = ReceivedFile(path, file_name, int(entry["size"]), str(entry["sha256"]), {"name": name})
            with request_folder(folder) as scratch:
                try:
                    upload = parse(services, file, unit, scratch)
                except IntegumentError as error:
                    if error.code in NOT_THE_FILE:
                        raise
                    refused.append(RefusedSubject(name, error.code, error.message))
                    continue
                meshes.append((name, services.meshes.create(workspace, upload, reserved_bytes=reserved_bytes)))
            path.unlink()
        yield TakenArchive(tuple(meshes), tuple(refused), tuple(map(str, told["ignored"])))
    except BaseException:
        for _, record in meshes:
            services.meshes.delete(workspace, record.id)
        raise


def _unpack(services: Services, received: ReceivedFile, folder: Path, *, volumes: bool) -> dict[str, Any]:
    settings = services.settings
    payload = {
        "path": str(received.path),
        "file_name": received.file_name,
        "out_dir": str(folder),
        "volumes": volumes,
        "most": settings.cohort_subjects,
        "most_bytes": int(settings.job_file_bytes),
    }
    return call(services.nursery, TARGET, payload, limits_of(services), folder, readable=[received.path])
