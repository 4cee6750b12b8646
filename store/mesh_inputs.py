"""From a link in a job's inputs to the bytes it stands for, at the moment the job is accepted."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from core.errors import InputError, StateError
from core.schema.reference import (
    COIL_MEDIA_TYPE,
    FIELD_MEDIA_TYPE,
    MESH_HREF,
    MESH_MEDIA_TYPES,
    PACKAGE_MEDIA_TYPES,
    RESULT_HREF,
    VOLUME_MEDIA_TYPE,
)
from store.blobs import Blobs
from store.database import Database
from store.job import JobOutput, JobStatus, MeshInput
from store.jobs import Jobs
from store.meshes import CANONICAL_MEDIA_TYPE, Meshes
from store.workspace import WorkspaceId

STL_HEADER_BYTES, STL_FACE_BYTES = 84, 50
PACKED_FACE_BYTES = 100  # measured 110 to 170: STL and solver files of every surface, deflated
NUMBERS_PER_FACE = 15  # of a field: 58 bytes for each number of a gmsh file were measured, 31 of text; a face is counted as 900
VOXELS_PER_FACE = 20  # measured: filters take about 40 bytes for each voxel around a label

_HREF = re.compile(rf"(?:https?://[^/]+)?(?P<path>{MESH_HREF}|{RESULT_HREF})")


class MeshInputs:
    """Resolves `/v1/meshes/{id}` and `/v1/jobs/{id}/results/{output}`."""

    def __init__(self, db: Database, blobs: Blobs) -> None:
        self._blobs = blobs
        self._meshes = Meshes(db, blobs)
        self._jobs = Jobs(db)

    def resolve(self, workspace: WorkspaceId, href: str) -> MeshInput:
        """The mesh behind a link; its blob is made young, so it outlives any sweep until the job's row refers to it.

        Raises InputError `reference.invalid` (no such link here), `reference.not_found` (nothing there),
        `reference.not_ready` (that job has not succeeded, nor left such an output when it failed), `reference.not_a_mesh` (that
        output is no mesh)."""
        mesh = self._find(workspace, href)
        if mesh.media_type not in MESH_MEDIA_TYPES:
            raise InputError("reference.not_a_mesh", f"output '{mesh.file_name}' is {mesh.media_type}, not a mesh", href=href)
        return mesh

    def resolve_package(self, workspace: WorkspaceId, href: str) -> MeshInput:
        """The package behind a link, kept as long as a mesh.

        Raises InputError as `resolve`, with `reference.not_a_package` if that output is none."""
        package = self._find(workspace, href)
        if package.media_type not in PACKAGE_MEDIA_TYPES:
            raise InputError(
                "reference.not_a_package", f"'{package.file_name}' is {package.media_type}, not the package of a job", href=href
            )
        return package

    def resolve_volume(self, workspace: WorkspaceId, href: str) -> MeshInput:
        """The label volume behind a link, kept as long as a mesh.

        Raises InputError as `resolve`, with `reference.not_a_volume` if that upload is a mesh."""
        return self._find_kind(workspace, href, VOLUME_MEDIA_TYPE, "reference.not_a_volume", "a label volume")

    def resolve_field(self, workspace: WorkspaceId, href: str) -> MeshInput:
        """The field behind a link, kept as long as a mesh.

        Raises InputError as `resolve`, with `reference.not_a_field` if that upload is something else."""
        return self._find_kind(workspace, href, FIELD_MEDIA_TYPE, "reference.not_a_field", "a field")

    def resolve_coil(self, workspace: WorkspaceId, href: str) -> MeshInput:
        """The coil behind a link, kept as long as a mesh.

        Raises InputError as `resolve`, with `reference.not_a_coil` if that upload is something else."""
        return self._find_kind(workspace, href, COIL_MEDIA_TYPE, "reference.not_a_coil", "a coil")

    def _find_kind(self, workspace: WorkspaceId, href: str, media_type: str, code: str, words: str) -> MeshInput:
        """What is behind the link; anything but `media_type` is refused by `code` as not being `words`."""
        found = self._find(workspace, href)
        if found.media_type != media_type:
            raise InputError(code, f"'{found.file_name}' is {found.media_type}, not {words}", href=href)
        return found

    def _find(self, workspace: WorkspaceId, href: str) -> MeshInput:
        match = _HREF.fullmatch(href)
        if match is None:
            raise InputError("reference.invalid", f"{href!r} is no link to a mesh or a result of this server", href=href)
        parts = match["path"].split("/")
        try:
            mesh = (
                self._upload(workspace, href, parts[3])
                if parts[2] == "meshes"
                else self._result(workspace, href, parts[3], parts[5])
            )
        except StateError:
            raise InputError("reference.not_found", f"there is nothing at {match['path']}", href=href) from None
        if not self._blobs.touch(mesh.sha256):
            raise InputError("reference.not_found", f"the bytes of {match['path']} are gone", href=href)
        return mesh

    def _upload(self, workspace: WorkspaceId, href: str, mesh_id: str) -> MeshInput:
        record = self._meshes.get(workspace, mesh_id)
        media_type, faces = CANONICAL_MEDIA_TYPE, record.faces
        if record.volume is not None:
            media_type, faces = VOLUME_MEDIA_TYPE, _weigh(record.volume)
        elif record.field is not None:
            media_type, faces = FIELD_MEDIA_TYPE, int(record.field["numbers"]) // NUMBERS_PER_FACE
        elif record.coil is not None:
            media_type = COIL_MEDIA_TYPE
        return MeshInput(href, record.name, record.canonical_sha256, media_type, record.file_name, record.sha256, faces)

    def _result(self, workspace: WorkspaceId, href: str, job_id: str, name: str) -> MeshInput:
        job = self._jobs.get(workspace, job_id)
        output = job.outputs.get(name)
        has_left_it = job.status is JobStatus.FAILED and output is not None
        if job.status is not JobStatus.SUCCESSFUL and not has_left_it:
            raise InputError(
                "reference.not_ready", f"job {job_id} is {job.status}, it has no '{name}' to build on", href=href, job=job_id
            )
        if output is None:
            raise InputError(
                "reference.not_found", f"job {job_id} has no output '{name}', only {', '.join(job.outputs)}", href=href
            )
        stem, faces = PurePath(output.file_name).stem, count_faces(output)
        return MeshInput(href, stem, output.sha256, output.media_type, output.file_name, faces=faces)


def _weigh(volume: Mapping[str, Any]) -> int:
    """Faces that need as much as the surfaces of a label volume and its voxels: what a job is sized by."""
    voxels: list[int] = volume["voxels"]
    return int(volume["expected_faces"]) + math.prod(voxels) // VOXELS_PER_FACE


def count_faces(output: JobOutput) -> int:
    """By its size: of a binary STL exactly, of a package about, rather too many."""
    if output.media_type in PACKAGE_MEDIA_TYPES:
        return output.size // PACKED_FACE_BYTES
    return max(output.size - STL_HEADER_BYTES, 0) // STL_FACE_BYTES
