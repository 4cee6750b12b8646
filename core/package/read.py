"""Read a package back: what its STL files hold, not what we meant to write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZipFile

from pydantic import ValidationError

from core.errors import InputError
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.package.entries import open_zip, read_text, unpack
from core.package.manifest import FILE_NAME, FORMAT_VERSION, Manifest, TissueEntry


@dataclass(frozen=True, eq=False, slots=True)
class ReadPackage:
    """What a package says, and its surfaces by tissue name in mm, in nesting order, welded by exact coordinates."""

    manifest: Manifest
    surfaces: Mapping[str, Mesh]


def read_package(zip_path: Path) -> ReadPackage:
    """Raises: InputError `package.corrupt` if it is no package or a file is missing, `package.checksum_mismatch` if a file is
    not the one the manifest names, LimitError `package.too_large`, and those of `read_meshes`."""
    with open_zip(zip_path) as archive, TemporaryDirectory(prefix="shells-") as scratch:
        manifest = _manifest(archive, zip_path.name)
        return ReadPackage(manifest, {tissue.name: _surface(archive, tissue, Path(scratch)) for tissue in manifest.tissues})


def read_shells(zip_path: Path) -> dict[str, Mesh]:
    """The surfaces alone. Raises: as `read_package`."""
    return dict(read_package(zip_path).surfaces)


def _manifest(archive: ZipFile, zip_name: str) -> Manifest:
    text = read_text(archive, FILE_NAME)
    try:
        manifest = Manifest.model_validate_json(text)
    except ValidationError as error:
        raise InputError("package.corrupt", f"{zip_name} is no package of this software: {error}") from error
    if manifest.format_version != FORMAT_VERSION:
        raise InputError(
            "package.corrupt", f"{zip_name} has format version {manifest.format_version}, {FORMAT_VERSION} is understood"
        )
    return manifest


def _surface(archive: ZipFile, tissue: TissueEntry, scratch: Path) -> Mesh:
    path = scratch / "surface.stl"
    found = unpack(archive, tissue.file, path)
    if found != tissue.sha256:
        raise InputError(
            "package.checksum_mismatch",
            f"the surface of '{tissue.name}' has checksum {found}, the manifest says {tissue.sha256}",
            name=tissue.name,
        )
    return read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh
