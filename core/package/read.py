"""Read a package back: what its STL files hold, not what we meant to write."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import BadZipFile, ZipFile

from pydantic import ValidationError

from core.errors import InputError
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.package.manifest import FILE_NAME, FORMAT_VERSION, Manifest


@dataclass(frozen=True, eq=False, slots=True)
class ReadPackage:
    """What a package says, and its surfaces by tissue name in mm, in nesting order, welded by exact coordinates."""

    manifest: Manifest
    surfaces: Mapping[str, Mesh]


def read_package(zip_path: Path) -> ReadPackage:
    """Raises: InputError `package.corrupt` if it is no package or a file is missing, `package.checksum_mismatch` if a file is
    not the one the manifest names, and those of `read_meshes`."""
    try:
        with ZipFile(zip_path) as archive:
            manifest = Manifest.model_validate_json(archive.read(FILE_NAME))
            surfaces = {tissue.name: (archive.read(tissue.file), tissue.sha256) for tissue in manifest.tissues}
    except (BadZipFile, KeyError, ValidationError) as error:
        raise InputError("package.corrupt", f"{zip_path.name} is no package of this software: {error}") from error
    if manifest.format_version != FORMAT_VERSION:
        raise InputError(
            "package.corrupt", f"{zip_path.name} has format version {manifest.format_version}, {FORMAT_VERSION} is understood"
        )
    with TemporaryDirectory(prefix="shells-") as scratch:
        return ReadPackage(
            manifest, {name: _read(Path(scratch), name, data, sha256) for name, (data, sha256) in surfaces.items()}
        )


def read_shells(zip_path: Path) -> dict[str, Mesh]:
    """The surfaces alone. Raises: as `read_package`."""
    return dict(read_package(zip_path).surfaces)


def _read(scratch: Path, name: str, data: bytes, sha256: str) -> Mesh:
    found = hashlib.sha256(data).hexdigest()
    if found != sha256:
        raise InputError(
            "package.checksum_mismatch", f"the surface of '{name}' has checksum {found}, the manifest says {sha256}", name=name
        )
    path = scratch / "surface.stl"
    path.write_bytes(data)
    return read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh
