"""Which format a file is in: its first bytes must agree with its name."""

from __future__ import annotations

from pathlib import Path, PurePath

from core.errors import InputError
from core.io import stl_binary
from core.io.mat import is_hdf5
from core.io.naming import clean_name

HEAD_BYTES = 1024
ARCHIVES = {
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "gzip-compressed",
    b"BZh": "bzip2-compressed",
    b"\xfd7zXZ\x00": "xz-compressed",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive",
}
MAT_VERSIONS = (b"\x00\x01", b"\x01\x00")


def sniff(path: Path, file_name: str, format_of: dict[str, str]) -> str:
    """The format's name. `format_of` maps extensions (".stl") to formats; `file_name` is the user's, `path` our own.

    Formats with a signature (PLY, MAT) go by it; STL and OBJ have none and go by the extension, STL also by its size
    or first word where the extension says nothing.
    Raises: InputError `upload.empty`, `format.unknown`, `format.mismatch`.
    """
    size = path.stat().st_size
    if size == 0:
        raise InputError("upload.empty", "the file has 0 bytes", bytes=0)
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    named = format_of.get(PurePath(file_name).suffix.lower())
    if named in (None, "stl") and _is_binary_stl(head, size):
        return "stl"  # its header may be anything, so the exact size outweighs any signature
    packed = next((words for mark, words in ARCHIVES.items() if head.startswith(mark)), None)
    if packed:
        raise InputError("format.unknown", f"the file is {packed}; unpack it and upload the mesh itself", bytes=size)
    signed = _by_signature(head)
    if signed and named and signed != named:
        raise InputError("format.mismatch", f"the name '{clean_name(file_name)}' says {named}, the content is {signed}")
    found = signed or named or ("stl" if head.lstrip()[:5].lower() == b"solid" else None)
    if found is None:
        known = ", ".join(format_of)
        raise InputError("format.unknown", f"'{clean_name(file_name)}' is in no known format; known are {known}", bytes=size)
    return found


def _by_signature(head: bytes) -> str | None:
    if head.startswith((b"ply\n", b"ply\r")):
        return "ply"
    if is_hdf5(head) or (head[126:128] in (b"IM", b"MI") and head[124:126] in MAT_VERSIONS):
        return "mat"
    return None


def _is_binary_stl(head: bytes, size: int) -> bool:
    count = stl_binary.declared_count(head)
    return count > 0 and size == stl_binary.file_size(count)
