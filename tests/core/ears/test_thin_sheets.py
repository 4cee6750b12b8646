"""Plates of known thickness."""

import numpy as np
import pytest

from core.ears.thin_sheets import find_thin_sheets


@pytest.mark.parametrize(("limit", "thin"), [(3.0, False), (5.5, True)])
def test_a_plate_is_thin_below_its_thickness_only(limit, thin):
    x, y = np.meshgrid(np.arange(10.0), np.arange(10.0))
    flat = np.column_stack([x.ravel(), y.ravel()])
    points = np.vstack([np.column_stack([flat, np.zeros(100)]), np.column_stack([flat, np.full(100, 5.0)])])
    normals = np.vstack([np.tile([0, 0, -1.0], (100, 1)), np.tile([0, 0, 1.0], (100, 1))])
    assert (find_thin_sheets(points, normals, limit) == thin).all()
    # the air between two plates is no sheet
    assert not find_thin_sheets(points, -normals, limit).any()
