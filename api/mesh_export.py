"""Stored meshes as files in other formats, or coarser ones for the eye."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from api.downloads import Download, read_file
from api.intake import limits_of
from api.services import Services
from sandbox.call import call

TARGET = "core.processes.export:run"
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
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    media_type, extension = WRITTEN_AS[file_format]
    return Download(partial(read_file, path), path.stat().st_size, sha256, media_type, mesh.name + extension)


def _export(services: Services, mesh: StoredMesh, file_format: str, most_faces: int | None, folder: Path, path: Path) -> None:
    stored = services.blobs.fetch(mesh.sha256, folder).absolute()
    payload = {
        "path": str(stored),
        "media_type": mesh.media_type,
        "file_name": mesh.file_name,
        "out_path": str(path),
        "format": file_format,
        "name": mesh.name,
        "most_faces": most_faces,
    }
    call(services.nursery, TARGET, payload, limits_of(services), folder, readable=[stored])
