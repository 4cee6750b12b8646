"""MAT files of version 7.3: HDF5 under rules that keep a crafted file from reading others or from unpacking without bound.

HDF5 can point out of the file in three ways (external links, external storage, virtual datasets), all unasked.
So names are looked up one at a time at the top, only hard links count, and storage, filters and size are checked before
a dataset's extent is asked for, as asking a virtual one already opens its sources.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, IntegumentError, LimitError
from core.io.hdf5_chunks import FILTER_NAMES, read_chunks
from core.io.mat_variable import LARGEST_ARRAY_BYTES, MatVariable
from core.io.naming import clean_name

MOST_NAMES = 1000
LONGEST_CLASS_NAME = 64


@contextmanager
def open_mat73(path: Path) -> Iterator[Mat73File]:
    """Open for reading.

    Raises: InputError `hdf5.corrupt`, `hdf5.link_refused`, `hdf5.filter_refused`; LimitError `hdf5.too_large`.
    """
    with _as_corrupt(), h5py.File(path, "r", locking=False) as file:
        yield Mat73File(file)


class Mat73File:
    """An open HDF5 file; variables are the hard-linked objects of the root group."""

    def __init__(self, file: h5py.File) -> None:
        self._root = file.id
        self._bytes = file.id.get_filesize()
        count = self._root.get_num_objs()
        if count > MOST_NAMES:
            raise LimitError(
                "hdf5.too_large", f"the file has {count} names, {MOST_NAMES} are allowed", names=count, limit=MOST_NAMES
            )
        self._names: list[bytes] = []
        self._variables: list[MatVariable] = []
        for number in range(count):
            name = self._root.get_objname_by_idx(number)
            self._require_hard_link(name)
            if not name.startswith(b"#"):  # MATLAB's own book-keeping
                self._variables.append(self._describe(name, len(self._names)))
                self._names.append(name)

    @property
    def variables(self) -> tuple[MatVariable, ...]:
        """All variables by name."""
        return tuple(self._variables)

    def load(self, variable: MatVariable) -> NDArray[np.float64]:
        """The numbers of one matrix as doubles in MATLAB's shape."""
        if variable.bytes_unpacked > LARGEST_ARRAY_BYTES:
            raise _too_large(f"variable {variable.name} of shape {variable.shape}", variable.bytes_unpacked)
        dataset = h5py.h5o.open(self._root, self._names[variable.place])
        if dataset.get_create_plist().get_layout() == h5py.h5d.CHUNKED:
            stored = read_chunks(dataset, self._bytes)
        else:
            stored = np.empty(variable.shape[::-1], dtype=np.float64)
            dataset.read(h5py.h5s.ALL, h5py.h5s.ALL, stored)
        return stored.T  # MATLAB counts columns first, HDF5 rows

    def _require_hard_link(self, name: bytes) -> None:
        if self._root.links.get_info(name).type != h5py.h5l.TYPE_HARD:
            raise InputError(
                "hdf5.link_refused", f"{clean_name(name)!r} is a soft or external link; only data inside the file itself is read"
            )

    def _describe(self, name: bytes, place: int) -> MatVariable:
        shown = clean_name(name)
        node = h5py.h5o.open(self._root, name)
        if h5py.h5a.exists(node, b"MATLAB_object_decode"):
            return MatVariable(shown, "object", (), place)
        matlab_class = _read_class(node)
        if not isinstance(node, h5py.h5d.DatasetID):
            return MatVariable(shown, matlab_class or "struct", (), place)
        _require_plain_storage(node, shown)
        kind = node.get_type()
        if not isinstance(kind, (h5py.h5t.TypeIntegerID, h5py.h5t.TypeFloatID)):
            return MatVariable(shown, matlab_class or "not numeric", (), place)
        shape = node.get_space().get_simple_extent_dims()[::-1]
        return MatVariable(shown, matlab_class or "double", shape, place)


def _require_plain_storage(dataset: h5py.h5d.DatasetID, name: str) -> None:
    """Refuse numbers that lie in other files, behind foreign filters or in chunks larger than any array may be."""
    storage = dataset.get_create_plist()
    layout = storage.get_layout()
    if layout == h5py.h5d.VIRTUAL or storage.get_external_count():
        kind = "a virtual dataset" if layout == h5py.h5d.VIRTUAL else "stored in another file"
        raise InputError("hdf5.link_refused", f"variable {name} is {kind}; only data inside the file itself is read")
    for number in range(storage.get_nfilters()):
        code = storage.get_filter(number)[0]
        if code not in FILTER_NAMES:
            allowed = ", ".join(FILTER_NAMES.values())
            raise InputError("hdf5.filter_refused", f"variable {name} uses filter {code}; allowed are {allowed}", filter=code)
    if layout == h5py.h5d.CHUNKED:
        chunk_bytes = math.prod(storage.get_chunk()) * dataset.get_type().get_size()
        if chunk_bytes > LARGEST_ARRAY_BYTES:
            raise _too_large(f"a chunk of variable {name}", chunk_bytes)


def _too_large(what: str, size: int) -> LimitError:
    return LimitError(
        "hdf5.too_large", f"{what} takes {size} bytes, {LARGEST_ARRAY_BYTES} are allowed", bytes=size, limit=LARGEST_ARRAY_BYTES
    )


def _read_class(node: h5py.h5g.GroupID | h5py.h5d.DatasetID) -> str:
    """The short text in attribute MATLAB_class, or "" where there is none."""
    if not h5py.h5a.exists(node, b"MATLAB_class"):
        return ""
    attribute = h5py.h5a.open(node, b"MATLAB_class")
    kind = attribute.get_type()
    if not isinstance(kind, h5py.h5t.TypeStringID) or kind.is_variable_str() or kind.get_size() > LONGEST_CLASS_NAME:
        raise InputError("hdf5.corrupt", "an attribute MATLAB_class is not a short text")
    if attribute.get_space().get_simple_extent_npoints() != 1:
        raise InputError("hdf5.corrupt", "an attribute MATLAB_class is not a single text")
    text = np.empty(attribute.get_space().get_simple_extent_dims(), dtype=f"S{kind.get_size()}")
    attribute.read(text)
    return clean_name(bytes(text.ravel()[0]))


@contextmanager
def _as_corrupt() -> Iterator[None]:
    """Turn what HDF5 says about damaged bytes into an InputError."""
    try:
        yield
    except (IntegumentError, MemoryError):
        raise
    except Exception as error:  # noqa: BLE001 - h5py maps HDF5's errors to nearly every built-in class
        reason = clean_name(str(error).splitlines()[0] if str(error) else type(error).__name__)
        raise InputError("hdf5.corrupt", f"the HDF5 file is damaged or cut off: {reason}") from None
