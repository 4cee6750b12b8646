"""A heap of faces by priority: lowest first, ties by number, so that the order is the same every time.

An entry is one integer: the bits of the priority as float32 (not negative, so they sort like the number), then the face.
Every entry has four children: they lie side by side in memory, and the heap is half as deep as with two. Several heaps share an
array, each from its base on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.decimation.kernel import kernel

Ints = NDArray[np.int64]


@kernel
def entry(priority: float, face: int, bits: NDArray[np.int32], number: NDArray[np.float32]) -> np.int64:
    """The entry of a face; bits and number are the same four bytes, the caller's scratch."""
    number[0] = max(priority, 0.0)
    return (np.int64(bits[0]) << 32) | np.int64(face)


@kernel
def push(heap: Ints, base: int, size: int, code: np.int64) -> int:
    """Add an entry to the heap that begins at `base` and has `size` entries; returns the new size."""
    at = size
    while at > 0:
        parent = (at - 1) >> 2
        if heap[base + parent] <= code:
            break
        heap[base + at] = heap[base + parent]
        at = parent
    heap[base + at] = code
    return size + 1


@kernel
def replace_first(heap: Ints, base: int, size: int, code: np.int64) -> None:
    """Put an entry in the place of the first, and restore the order."""
    at = 0
    while True:
        first = 4 * at + 1
        if first >= size:
            break
        child = first
        for other in range(first + 1, min(first + 4, size)):
            if heap[base + other] < heap[base + child]:
                child = other
        if heap[base + child] >= code:
            break
        heap[base + at] = heap[base + child]
        at = child
    heap[base + at] = code


@kernel
def pop(heap: Ints, base: int, size: int) -> int:
    """Drop the first entry; returns the new size."""
    if size > 1:
        replace_first(heap, base, size - 1, heap[base + size - 1])
    return size - 1
