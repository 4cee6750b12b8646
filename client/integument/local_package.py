"""A package on this disk: its surfaces as files, checked against its manifest."""

from __future__ import annotations

import json
import re
from hashlib import sha256
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

from integument.errors import ArgumentError

MANIFEST = "manifest.json"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")


def unpack_surfaces(package: Path, folder: Path) -> dict[str, Path]:
    """Tissue name -> STL in mm in `folder`, in nesting order.

    Raises: ArgumentError if the file is no package, or a surface is not the one its manifest names.
    """
    try:
        with ZipFile(package) as archive:
            tissues = json.loads(archive.read(MANIFEST))["tissues"]
            return {str(tissue["name"]): _unpack(archive, tissue, folder, package) for tissue in tissues}
    except OSError as error:
        raise ArgumentError(f"cannot read {package}: {error.strerror or error}") from error
    except (BadZipFile, KeyError, TypeError, ValueError) as error:
        raise ArgumentError(f"{package} is no package of Integument: {error}") from error


def _unpack(archive: ZipFile, tissue: Any, folder: Path, package: Path) -> Path:
    name, data = str(tissue["name"]), archive.read(tissue["file"])
    if not _NAME.fullmatch(name):
        raise ArgumentError(f"{package} has a surface called {name!r}, which can name no file")
    if sha256(data).hexdigest() != tissue["sha256"]:
        raise ArgumentError(f"{package}: the surface '{name}' is not the one the manifest names")
    path = folder / f"{name}.stl"
    path.write_bytes(data)
    return path
