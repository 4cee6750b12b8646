"""What reads files: any bytes must become a mesh or one of our named errors."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from pathlib import Path

from core.errors import InputError, LimitError
from core.io.ccd import read_ccd
from core.io.msh import read_msh
from core.io.registry import read_meshes
from core.io.tcd import read_tcd
from core.io.text_table import read_table
from core.io.volume import read_volume
from core.mesh import Mesh
from core.package.read import read_package

Target = Callable[[bytes], None]


@cache
def folder() -> Path:
    """In memory where there is such a place: a fuzzer writes a file per try."""
    memory = Path("/dev/shm")
    held = tempfile.TemporaryDirectory(prefix="fuzz-", dir=memory if memory.is_dir() else None)
    _held.append(held)
    return Path(held.name)


_held: list[tempfile.TemporaryDirectory[str]] = []


def read_upload(data: bytes, extension: str) -> None:
    """As an upload called skin.<extension>."""
    path = folder() / "upload"
    path.write_bytes(data)
    with suppress(InputError, LimitError):
        intake = read_meshes(path, file_name=f"skin.{extension}", unit="mm")
        if not all(isinstance(named.mesh, Mesh) for named in intake.meshes):
            raise AssertionError("the reader made something else than a mesh")


def read_labels(data: bytes, name: str) -> None:
    """As an upload of that name."""
    path = folder() / "volume"
    path.write_bytes(data)
    with suppress(InputError, LimitError):
        volume, _findings, _format = read_volume(path, "mm", name)
        if not volume.counts():
            raise AssertionError("a volume without labels was let through")


def read_zip(data: bytes) -> None:
    """As a package of an earlier job."""
    path = folder() / "package.zip"
    path.write_bytes(data)
    with suppress(InputError, LimitError):
        read_package(path)


def read_source(data: bytes, read: Callable[[Path], object]) -> None:
    """As a file with a field, or with a coil that makes one."""
    path = folder() / "source"
    path.write_bytes(data)
    with suppress(InputError, LimitError):
        read(path)


READERS: dict[str, Target] = {
    "stl": partial(read_upload, extension="stl"),
    "mat": partial(read_upload, extension="mat"),
    "hdf5": partial(read_upload, extension="mat"),
    "ply": partial(read_upload, extension="ply"),
    "obj": partial(read_upload, extension="obj"),
    "unnamed": partial(read_upload, extension=""),
    "nifti": partial(read_labels, name="labels.nii.gz"),
    "mgh": partial(read_labels, name="labels.mgz"),
    "msh": partial(read_source, read=partial(read_msh, unit="mm")),
    "tcd": partial(read_source, read=read_tcd),
    "ccd": partial(read_source, read=read_ccd),
    "table": partial(read_source, read=read_table),
    "package": read_zip,
}
