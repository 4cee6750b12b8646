"""A table of colours keeps what is drawn: what fills areas to the bit, rims of lines as far as nobody sees."""

from __future__ import annotations

import numpy as np

from core.reports.figures.colour_table import LARGEST_SHIFT, SIZE, colour_table


def ramps(*ends: tuple[int, int, int]) -> np.ndarray:
    """Rows from white to a colour, as the rims of its lines have them, and a large field of the colour itself."""
    shares = np.linspace(0.0, 1.0, 200)[:, None]
    rows = [np.rint(255 + shares * (np.array(end) - 255)) for end in ends]
    fields = [np.broadcast_to(np.array(end), (2000, 3)) for end in ends]
    return np.concatenate([*rows, *fields]).astype(np.uint8)[None]


def test_colours_of_areas_stay_and_rims_move_by_little() -> None:
    picture = ramps((214, 96, 77), (120, 177, 89), (34, 38, 43), (240, 199, 69))
    found = colour_table(picture)
    assert found is not None
    table, number = found
    assert len(table) == SIZE
    shown = table[number].astype(int)
    assert np.abs(shown - picture).max() <= LARGEST_SHIFT
    assert np.array_equal(shown[0, 800:], picture[0, 800:])


def test_few_colours_are_kept_to_the_bit_and_told_apart() -> None:
    picture = np.random.default_rng(3).integers(0, 6, (50, 40, 3)).astype(np.uint8) * 50
    found = colour_table(picture)
    assert found is not None
    table, number = found
    assert np.array_equal(table[number], picture)
    assert len(np.unique(table, axis=0)) == len(table)


def test_what_needs_more_colours_gets_no_table() -> None:
    random = np.random.default_rng(5)
    assert colour_table(random.integers(0, 256, (200, 200, 3), dtype=np.uint8)) is None  # more than are counted
    assert colour_table(random.integers(0, 256, (30, 30, 3), dtype=np.uint8)) is None  # counted, but too far apart
