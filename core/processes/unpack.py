"""An archive with many meshes, unpacked in the limited child: bytes from outside. What is in the files is not looked at."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import Any
from zipfile import ZipFile

from core.errors import InputError, LimitError
from core.io.naming import clean_name, make_unique, stem_of
from core.io.volume import EXTENSIONS as VOLUMES
from core.package.entries import BROKEN, open_zip, unpack

MESHES = (".stl", ".mat", ".ply", ".obj")
IGNORED_SHOWN = 100
LONGEST_FILE_NAME = 200


def run(payload: dict[str, Any], channel: object) -> dict[str, Any]:
    """Unpack the zip at payload["path"] (called `file_name` by the user) into `out_dir`.

    payload["volumes"]: label volumes are wanted in place of meshes.
    Returns {"files": [{"name", "file_name", "path", "size", "sha256"} or {"name", "file_name", "code", "message"}], "ignored":
    [names]}: wanted files by how their names end, in the order of their names; those that are broken with the reason.
    Raises: InputError `archive.corrupt`, `archive.empty`, LimitError `archive.too_large`, `archive.too_many`.
    """
    del channel
    path, shown = Path(payload["path"]), str(payload["file_name"])
    try:
        with open_zip(path) as archive:
            endings = VOLUMES if payload["volumes"] else MESHES
            wanted, ignored = _choose(archive, endings)
            _require_some(wanted, shown, endings)
            _require_bounds(archive, wanted, shown, payload["most"], payload["most_bytes"])
            names = make_unique(clean_name(stem_of(PurePosixPath(name).name, endings), "subject") for name in wanted)
            files = [
                _unpack(archive, entry, name, Path(payload["out_dir"]) / str(number))
                for number, (entry, name) in enumerate(zip(wanted, names, strict=True))
            ]
    except InputError as error:
        if error.code != "package.corrupt":
            raise
        raise InputError("archive.corrupt", f"{shown} is no zip that can be unpacked: {error.__cause__}") from error
    except LimitError as error:
        if error.code != "package.too_large":
            raise
        raise LimitError("archive.too_large", error.message) from error
    return {"files": files, "ignored": ignored[:IGNORED_SHOWN]}


def _choose(archive: ZipFile, endings: tuple[str, ...]) -> tuple[list[str], list[str]]:
    """Wanted files and others; folders and what systems put beside files are neither."""
    names = sorted(
        {name for name in archive.namelist() if not name.endswith("/") and not PurePosixPath(name).name.startswith((".", "__"))}
    )
    names = [name for name in names if not name.startswith("__MACOSX/")]
    wanted = [name for name in names if name.lower().endswith(endings)]
    return wanted, [clean_name(name) for name in names if name not in set(wanted)]


def _require_some(wanted: list[str], shown: str, endings: tuple[str, ...]) -> None:
    if not wanted:
        raise InputError("archive.empty", f"{shown} holds no file whose name ends in {', '.join(endings)}")


def _require_bounds(archive: ZipFile, wanted: list[str], shown: str, most: int, most_bytes: int) -> None:
    if len(wanted) > most:
        raise LimitError(
            "archive.too_many", f"{shown} holds {len(wanted)} subjects, {most} are allowed", subjects=len(wanted), limit=most
        )
    size = sum(archive.getinfo(name).file_size for name in wanted)
    if size > most_bytes:
        raise LimitError(
            "archive.too_large", f"{shown} unpacks to {size} bytes, {most_bytes} are allowed", size=size, limit=most_bytes
        )


def _unpack(archive: ZipFile, entry: str, name: str, target: Path) -> dict[str, Any]:
    told = {"name": name, "file_name": clean_name(PurePosixPath(entry).name, "mesh")[-LONGEST_FILE_NAME:]}
    try:
        digest = unpack(archive, entry, target)
    except LimitError as error:
        return {**told, "code": "archive.too_large", "message": error.message}
    except BROKEN as error:
        return {**told, "code": "archive.corrupt", "message": f"it cannot be unpacked: {str(error) or type(error).__name__}"}
    return {**told, "path": str(target), "size": target.stat().st_size, "sha256": digest}
