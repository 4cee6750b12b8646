"""Files out of a zip whose writer is not trusted: bounded in number, size and ratio, and every way a zip can be broken is named.

Names are looked up, never used as paths; links and folders are therefore only bytes. Source: OWASP ASVS 5.0, V5.2.
"""

from __future__ import annotations

import errno
import hashlib
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from lzma import LZMAError
from pathlib import Path
from zipfile import BadZipFile, ZipFile, ZipInfo

from core.errors import InputError, LimitError

MOST_ENTRIES = 10_000
LARGEST_TEXT_BYTES = 16 * 1024**2
LARGEST_SURFACE_BYTES = 4 * 1024**3
LARGEST_RATIO = 200  # of a mesh: 3 to 5; of zeros: 1000
SMALL_BYTES = 1024**2  # below that no ratio does harm
CHUNK_BYTES = 1024**2
BROKEN = (  # all that zipfile and what it calls raise for broken, encrypted and unknown content
    *(BadZipFile, LZMAError, zlib.error, struct.error),
    *(EOFError, KeyError, NotImplementedError, OverflowError, RuntimeError, ValueError),
)


@contextmanager
def open_zip(path: Path) -> Iterator[ZipFile]:
    """Raises InputError `package.corrupt`, LimitError `package.too_large`; also for what is read within."""
    try:
        with ZipFile(path) as archive:
            if len(archive.infolist()) > MOST_ENTRIES:
                raise _too_large(f"{path.name} has {len(archive.infolist())} files, {MOST_ENTRIES} are allowed")
            yield archive
    except BROKEN as error:
        raise _corrupt(path, error) from error
    except OSError as error:
        if error.errno not in (None, errno.EINVAL):  # the disk is at fault; a zip may ask for a place before its beginning
            raise
        raise _corrupt(path, error) from error


def read_text(archive: ZipFile, name: str) -> bytes:
    """A small file, whole. Raises LimitError `package.too_large`, and what `open_zip` names."""
    entry = _bounded(archive, name, LARGEST_TEXT_BYTES)
    with archive.open(entry) as file:
        return file.read(entry.file_size + 1)


def unpack(archive: ZipFile, name: str, target: Path) -> str:
    """A large file, piece by piece; returns the SHA-256 of what was written. Raises as `read_text`."""
    entry, digest = _bounded(archive, name, LARGEST_SURFACE_BYTES), hashlib.sha256()
    with archive.open(entry) as file, target.open("wb") as written:
        while piece := file.read(CHUNK_BYTES):  # zipfile gives no more than the size its directory states
            digest.update(piece)
            written.write(piece)
    return digest.hexdigest()


def _bounded(archive: ZipFile, name: str, largest: int) -> ZipInfo:
    entry = archive.getinfo(name)
    allowed = min(largest, max(SMALL_BYTES, LARGEST_RATIO * entry.compress_size))
    if entry.file_size > allowed:
        raise _too_large(
            f"'{name[:100]}' has {entry.file_size} bytes out of {entry.compress_size} packed ones, {allowed} are allowed"
        )
    return entry


def _corrupt(path: Path, error: Exception) -> InputError:
    return InputError("package.corrupt", f"{path.name} is no package of this software: {str(error) or type(error).__name__}")


def _too_large(message: str) -> LimitError:
    return LimitError("package.too_large", message)
