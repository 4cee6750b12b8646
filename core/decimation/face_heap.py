"""A heap of faces by priority: lowest first, ties by number, so that the order is the same every time.

An entry is one integer: the bits of the priority as float32 (not negative, so they sort like the number), then the face.
Every entry has four children: they lie side by side in memory, and the heap is half as deep as with two.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def entry(priority: float, face: int, bits: NDArray[np.int32], number: NDArray[np.float32]) -> np.int64:
    """The entry of a face; bits and number are the same four bytes, the caller's scratch."""
    number[0] = max(priority, 0.0)
    return (np.int64(bits[0]) << 32) | np.int64(face)


@njit(cache=True, nogil=True)
def push(heap: Ints, size: int, code: np.int64) -> int:
    """Add an entry; returns the new size."""
    at = size
    while at > 0:
        parent = (at - 1) >> 2
        if heap[parent] <= code:
            break
        heap[at] = heap[parent]
        at = parent
    heap[at] = code
    return size + 1


@njit(cache=True, nogil=True)
def replace_first(heap: Ints, size: int, code: np.int64) -> None:
    """Put an entry in the place of the first, and restore the order."""
    at = 0
    while True:
        first = 4 * at + 1
        if first >= size:
            break
        child = first
        for other in range(first + 1, min(first + 4, size)):
            if heap[other] < heap[child]:
                child = other
        if heap[child] >= code:
            break
        heap[at] = heap[child]
        at = child
    heap[at] = code


@njit(cache=True, nogil=True)
def pop(heap: Ints, size: int) -> int:
    """Drop the first entry; returns the new size."""
    if size > 1:
        replace_first(heap, size - 1, heap[size - 1])
    return size - 1
