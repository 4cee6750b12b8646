"""Checksums of the surfaces a job hands out, in its report."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from core.processes.outcome import OutputFile
from core.schema.report import Report

STL = "model/stl"


def with_checksums(report: Report, files: Sequence[OutputFile], out_dir: Path) -> Report:
    """The report with the SHA-256 of every STL file that is named like a mesh of it; those of a package are there already."""
    delivered = {file.name: out_dir / file.path for file in files if file.media_type == STL}
    meshes = {
        name: mesh.model_copy(update={"sha256": _sha256(delivered[name])}) if name in delivered and mesh.sha256 is None else mesh
        for name, mesh in report.meshes.items()
    }
    return report.model_copy(update={"meshes": meshes})


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
