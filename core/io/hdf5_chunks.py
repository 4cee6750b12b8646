"""Chunked HDF5 datasets, unpacked by our own hands.

HDF5 reads and locates the stored bytes, but its filters trust what the file says: a chunk of one byte under fletcher32 ends in a
segmentation fault (2.0.0), and a deflate stream is unpacked whatever size it has. Here every size is known before it is used.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable

import h5py
import numpy as np
from numpy.typing import NDArray

from core.errors import InputError

Filter = tuple[int, tuple[int, ...]]  # code, parameters
FILTER_NAMES = {h5py.h5z.FILTER_DEFLATE: "gzip", h5py.h5z.FILTER_SHUFFLE: "shuffle", h5py.h5z.FILTER_FLETCHER32: "fletcher32"}
CHECKSUM_BYTES = 4
MOST_CHUNKS = 100_000


def read_chunks(dataset: h5py.h5d.DatasetID, file_bytes: int) -> NDArray[np.float64]:
    """All numbers of a chunked dataset of known filters, as doubles in HDF5's shape.

    Raises: InputError `hdf5.corrupt` where stored sizes, checksums or the number of chunks are not what the shape needs.
    """
    storage = dataset.get_create_plist()
    shape, chunk_shape = dataset.get_space().get_simple_extent_dims(), storage.get_chunk()
    number_type = dataset.get_type().dtype
    filters = [_filter(storage.get_filter(number)) for number in range(storage.get_nfilters())]
    wanted = math.prod(-(-length // step) for length, step in zip(shape, chunk_shape, strict=True))
    stored = dataset.get_num_chunks()
    if stored != wanted or wanted > MOST_CHUNKS:
        raise _corrupt(f"a dataset of shape {shape} has {stored} chunks, {wanted} are needed and {MOST_CHUNKS} allowed")
    places: list[tuple[tuple[int, ...], int, int]] = []
    dataset.chunk_iter(lambda chunk: places.append((chunk.chunk_offset, chunk.filter_mask, chunk.size)))
    numbers = np.full(shape, np.nan)  # a chunk stored twice leaves another one not a number
    for offset, mask, size in places:
        if size > file_bytes or any(start >= length for start, length in zip(offset, shape, strict=True)):
            raise _corrupt(f"a chunk of {size} bytes at {offset} does not fit a file of {file_bytes} bytes and shape {shape}")
        _, packed = dataset.read_direct_chunk(offset)
        chunk_bytes = math.prod(chunk_shape) * number_type.itemsize
        chunk = np.frombuffer(undo_filters(packed, filters, mask, chunk_bytes, number_type.itemsize), number_type)
        window = tuple(slice(start, start + step) for start, step in zip(offset, chunk_shape, strict=True))
        target = numbers[window]
        target[...] = chunk.reshape(chunk_shape)[tuple(slice(length) for length in target.shape)]
    return numbers


def undo_filters(packed: bytes, filters: list[Filter], mask: int, chunk_bytes: int, item_bytes: int) -> bytes:
    """Bytes as stored -> bytes as written; `mask` has a bit for every filter that was left out for this chunk."""
    for place, (code, parameters) in reversed(list(enumerate(filters))):
        if not mask >> place & 1:
            packed = UNDO[code](packed, parameters, chunk_bytes, item_bytes)
    if len(packed) != chunk_bytes:
        raise _corrupt(f"a chunk unpacks to {len(packed)} bytes, {chunk_bytes} are needed")
    return packed


def fletcher32(data: bytes) -> int:
    """Checksum of HDF5's fletcher32 filter: two sums over big-endian 16-bit words, modulo 65535."""
    words = np.frombuffer(data + b"\0" * (len(data) % 2), ">u2").astype(np.uint64)
    weights = np.arange(len(words), 0, -1, dtype=np.uint64) % 65535
    return int((words * weights % 65535).sum() % 65535) << 16 | int(words.sum() % 65535)


def _unpack_gzip(packed: bytes, _parameters: tuple[int, ...], chunk_bytes: int, _item_bytes: int) -> bytes:
    stream = zlib.decompressobj()
    try:
        data = stream.decompress(packed, chunk_bytes + CHECKSUM_BYTES + 1)
    except zlib.error as error:
        raise _corrupt(f"a chunk cannot be unpacked: {error}") from None
    if not stream.eof:
        raise _corrupt(f"a chunk unpacks to more or less than its {chunk_bytes} bytes")
    return data


def _unshuffle(packed: bytes, parameters: tuple[int, ...], chunk_bytes: int, item_bytes: int) -> bytes:
    if parameters != (item_bytes,) or len(packed) != chunk_bytes:
        raise _corrupt(f"a chunk of {len(packed)} bytes was shuffled by {parameters}, {chunk_bytes} by {item_bytes} are needed")
    return np.frombuffer(packed, np.uint8).reshape(item_bytes, -1).T.tobytes()


def _check_fletcher32(packed: bytes, _parameters: tuple[int, ...], _chunk_bytes: int, _item_bytes: int) -> bytes:
    data, stored = packed[:-CHECKSUM_BYTES], int.from_bytes(packed[-CHECKSUM_BYTES:], "little")
    computed = fletcher32(data)
    # 0 and 65535 are the same number in these sums
    if any((stored >> shift & 0xFFFF) % 65535 != (computed >> shift & 0xFFFF) for shift in (0, 16)):
        raise _corrupt(f"a chunk has the checksum {computed:08x}, {stored:08x} was stored")
    return data


UNDO: dict[int, Callable[[bytes, tuple[int, ...], int, int], bytes]] = {
    h5py.h5z.FILTER_DEFLATE: _unpack_gzip,
    h5py.h5z.FILTER_SHUFFLE: _unshuffle,
    h5py.h5z.FILTER_FLETCHER32: _check_fletcher32,
}


def _filter(description: tuple[int, int, tuple[int, ...], bytes]) -> Filter:
    code, _flags, parameters, _name = description
    return code, tuple(parameters)


def _corrupt(message: str) -> InputError:
    return InputError("hdf5.corrupt", message)
