"""Stored meshes as files in other formats, or coarser ones for the eye; the field of a job likewise."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from api.downloads import Download, read_file
from api.intake import limits_of
from api.services import Services
from sandbox.call import call

TARGET = "core.processes.export:run"
FIELD_TARGET = "core.processes.export_field:run"
# as core.io.registry has them, which is loaded in children alone
WRITTEN_AS = {
    "stl": ("model/stl", ".stl"),
    "stl-ascii": ("model/stl", ".stl"),
    "mat": ("application/x-matlab-data", ".mat"),
    "ply": ("application/ply", ".ply"),
    "obj": ("model/obj", ".obj"),
    "glb": ("model/gltf-binary", ".glb"),
    "vtu": ("application/x-vtu", ".vtu"),
}


@dataclass(frozen=True, slots=True)
class StoredMesh:
    """A mesh among the blobs: an upload in canonical form, or an output of a job."""

    sha256: str
    media_type: str
    file_name: str
    name: str


def export_mesh(services: Services, mesh: StoredMesh, file_format: str, most_faces: int | None, folder: Path) -> Download:
    """Written by a child in `folder`, which has to stay until the answer is out. Coarser meshes are kept for the next time.

    Raises what `core.processes.export` raises, LimitError `limit.*`, InternalError `child.*`, `nursery.*`, `blob.missing`."""
    path = folder / "export"
    make = partial(_export, services, mesh, file_format, most_faces, folder)
    if most_faces is None:
        make(path)
    else:
        services.previews.put_into(path, make, mesh.sha256, mesh.media_type, mesh.name, file_format, most_faces)
    media_type, extension = WRITTEN_AS[file_format]
    return _download(path, media_type, mesh.name + extension)


def export_field(services: Services, field: StoredMesh, most_faces: int, folder: Path) -> Download:
    """The .msh that `fields` made, coarser, with magnitudes alone; else as `export_mesh`."""
    path = folder / "export"
    make = partial(_run, services, FIELD_TARGET, field, {"most_faces": most_faces}, folder)
    services.previews.put_into(path, make, field.sha256, field.media_type, most_faces)
    return _download(path, field.media_type, field.file_name)


def _export(services: Services, mesh: StoredMesh, file_format: str, most_faces: int | None, folder: Path, path: Path) -> None:
    payload = {
        "media_type": mesh.media_type,
        "file_name": mesh.file_name,
        "format": file_format,
        "name": mesh.name,
        "most_faces": most_faces,
    }
    _run(services, TARGET, mesh, payload, folder, path)


def _run(services: Services, target: str, stored: StoredMesh, payload: Mapping[str, Any], folder: Path, out_path: Path) -> None:
    path = services.blobs.fetch(stored.sha256, folder).absolute()
    paths = {"path": str(path), "out_path": str(out_path)}
    call(services.nursery, target, {**payload, **paths}, limits_of(services), folder, readable=[path])


def _download(path: Path, media_type: str, file_name: str) -> Download:
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    return Download(partial(read_file, path), path.stat().st_size, sha256, media_type, file_name)
