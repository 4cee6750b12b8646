"""Against tetrahedra whose numbers are known."""

from __future__ import annotations

import numpy as np
import pytest

from core.tetrahedra.element_quality import quality, radius_ratio, smallest_dihedral_deg, volumes

REGULAR = np.array([[(1, 1, 1), (-1, 1, -1), (1, -1, -1), (-1, -1, 1)]], dtype=float)
CORNER_OF_CUBE = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]], dtype=float)
NEEDLE = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1e-3)]])


def test_the_regular_one():
    assert quality(REGULAR)[0] == pytest.approx(1.0)
    assert smallest_dihedral_deg(REGULAR)[0] == pytest.approx(np.degrees(np.arccos(1 / 3)))
    assert volumes(REGULAR)[0] == pytest.approx(8 / 3)
    assert radius_ratio(REGULAR)[0] == pytest.approx(1.0)


def test_the_corner_of_a_cube():
    assert volumes(CORNER_OF_CUBE)[0] == pytest.approx(1 / 6)
    inscribed, circumscribed = 1 / (3 + np.sqrt(3)), np.sqrt(3) / 2
    assert radius_ratio(CORNER_OF_CUBE)[0] == pytest.approx(3 * inscribed / circumscribed)
    assert radius_ratio(1000 * CORNER_OF_CUBE + 7)[0] == pytest.approx(3 * inscribed / circumscribed)
    assert smallest_dihedral_deg(CORNER_OF_CUBE)[0] == pytest.approx(np.degrees(np.arctan(np.sqrt(2))))
    assert quality(CORNER_OF_CUBE)[0] == pytest.approx(6 * np.sqrt(2) / 6 / 1.5**1.5)


def test_inverted_is_negative_and_flat_is_nearly_nothing():
    assert volumes(REGULAR[:, [1, 0, 2, 3]])[0] == pytest.approx(-8 / 3)
    assert quality(REGULAR[:, [1, 0, 2, 3]])[0] == pytest.approx(-1.0)
    assert smallest_dihedral_deg(REGULAR[:, [1, 0, 2, 3]])[0] == pytest.approx(np.degrees(np.arccos(1 / 3)))
    assert quality(NEEDLE)[0] < 0.01
    assert quality(np.zeros((1, 4, 3)))[0] == 0.0
    assert radius_ratio(NEEDLE)[0] < 0.01
    assert radius_ratio(np.zeros((1, 4, 3)))[0] == 0.0
