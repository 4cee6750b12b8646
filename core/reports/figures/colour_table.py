"""Few colours for a drawing: lines and letters on paper need no more than a byte per pixel."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
SIZE = 256  # colours of a table
FREQUENT = 96  # of them: those of most pixels; the others are spread over what is left
MOST_DIFFERENT = 4096  # a shaded body has more, and is no drawing
LARGEST_SHIFT = 8  # of 255 in any channel: a colour farther from all of the table stands against it
_SLOTS = 4 * MOST_DIFFERENT  # of the hash table, a power of two
_MIX = 2654435761  # Knuth's multiplier: neighbouring colours come to lie apart
_EMPTY = -1


def colour_table(picture: Bytes) -> tuple[Bytes, Bytes] | None:
    """The colours (SIZE or fewer, 3) and for each pixel of a picture (H, W, 3 or more) the number of its colour (H, W).

    The most frequent colours stay as they are; others, on rims of lines and letters, may become the nearest one of the table, by
    LARGEST_SHIFT at most. None for a picture that has too many colours for that. Same picture, same table.
    """
    number = np.empty(picture.shape[:2], dtype=np.uint16)
    colours, count = np.empty((MOST_DIFFERENT, 3), dtype=np.uint8), np.zeros(MOST_DIFFERENT, dtype=np.int64)
    different = _count_colours(picture, number, colours, count)
    if different > MOST_DIFFERENT:
        return None
    colours, count = colours[:different], count[:different]
    table, nearest = _spread(colours.astype(np.int16), np.argsort(-count, kind="stable")[:FREQUENT])
    if np.abs(colours[table][nearest].astype(np.int16) - colours).max() > LARGEST_SHIFT:
        return None
    return colours[table], _numbers_in_table(number, nearest)


@njit(cache=True, nogil=True)
def _spread(colours: NDArray[np.int16], frequent: NDArray[np.int64]) -> tuple[NDArray[np.int64], Bytes]:
    """Numbers of the colours of a table: the frequent ones, then always the one farthest from all there are; and for each
    of the colours (N, 3) where in that table the nearest one stands."""
    chosen = np.empty(SIZE, np.int64)
    nearest, away = np.zeros(len(colours), np.uint8), np.full(len(colours), 256, np.int64)
    size, following = 0, int(frequent[0])
    while size < SIZE:
        chosen[size] = following
        farthest = 0
        for other in range(len(colours)):
            shift = 0
            for channel in range(3):
                apart = int(colours[other, channel]) - int(colours[following, channel])
                shift = max(shift, apart, -apart)
            if shift < away[other]:
                away[other], nearest[other] = shift, size
            if away[other] > away[farthest]:
                farthest = other
        size += 1
        if away[farthest] == 0:
            break
        following = frequent[size] if size < len(frequent) else farthest
    return chosen[:size], nearest


@njit(cache=True, nogil=True)
def _count_colours(picture: Bytes, number: NDArray[np.uint16], colours: Bytes, count: NDArray[np.int64]) -> int:
    """Number the colours in the order of their first pixel; one more than MOST_DIFFERENT as soon as there are too many.

    number (H, W), colours (MOST_DIFFERENT, 3), count (MOST_DIFFERENT,): out, count must come as zeros."""
    slots = np.full(_SLOTS, _EMPTY, np.int64)
    different = 0
    last, last_key, alike = np.int64(0), np.int64(_EMPTY), np.int64(0)
    for row in range(picture.shape[0]):
        for column in range(picture.shape[1]):
            red, green, blue = picture[row, column, 0], picture[row, column, 1], picture[row, column, 2]
            key = (np.int64(red) << 16) | (np.int64(green) << 8) | np.int64(blue)
            if key != last_key:
                slot = ((key * _MIX) >> 12) & (_SLOTS - 1)
                while slots[slot] != _EMPTY:
                    known = slots[slot]
                    if colours[known, 0] == red and colours[known, 1] == green and colours[known, 2] == blue:
                        break
                    slot = (slot + 1) & (_SLOTS - 1)
                if slots[slot] == _EMPTY:
                    if different == len(colours):
                        return different + 1
                    slots[slot] = different
                    colours[different, 0], colours[different, 1], colours[different, 2] = red, green, blue
                    different += 1
                count[last] += alike  # once for a run of pixels: each addition would wait for the one before
                last, last_key, alike = slots[slot], key, np.int64(0)
            alike += np.int64(1)
            number[row, column] = last
    count[last] += alike
    return different


@njit(cache=True, nogil=True)
def _numbers_in_table(number: NDArray[np.uint16], nearest: Bytes) -> Bytes:
    """For each pixel (H, W) where in the table its colour stands."""
    placed = np.empty(number.shape, np.uint8)
    for row in range(number.shape[0]):
        for column in range(number.shape[1]):
            placed[row, column] = nearest[number[row, column]]
    return placed
