"""A zip whose bytes depend on the files only: sorted entries, one date, one set of permissions."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

EARLIEST_DATE = (1980, 1, 1, 0, 0, 0)  # zip knows no earlier one
UNIX = 3
PLAIN_FILE = 0o100644
LEVEL = 4  # level 6 takes twice as long for 1 % on meshes
PACKED_ALREADY = {".png"}


def write_archive(out_path: Path, folder: Path, names: Iterable[str]) -> None:
    """Zip the files `names` (relative, with `/`) of a folder."""
    with ZipFile(out_path, "w") as archive:
        for name in sorted(names):
            entry = ZipInfo(name, EARLIEST_DATE)
            entry.create_system = UNIX
            entry.external_attr = PLAIN_FILE << 16
            method = ZIP_STORED if Path(name).suffix in PACKED_ALREADY else ZIP_DEFLATED
            archive.writestr(entry, (folder / name).read_bytes(), compress_type=method, compresslevel=LEVEL)
