from __future__ import annotations

import numpy as np
import pytest

from core.geometry.vertex_values import interpolate
from subjects.body import body


def test_vertices_keep_their_value_bit_for_bit_and_other_places_get_a_linear_one() -> None:
    skin = body(0)
    direction = np.array([0.3, -0.7, 0.2])
    values = skin.vertices @ direction
    chosen = skin.vertices[::50]
    assert np.array_equal(interpolate(values, skin, chosen), values[::50])
    weights = np.random.default_rng(3).dirichlet(np.ones(3), len(skin.faces))[::37]
    points = np.einsum("ij,ijk->ik", weights, skin.triangles()[::37])
    assert interpolate(values, skin, points) == pytest.approx(points @ direction, abs=1e-6)


def test_a_place_off_the_surface_gets_the_value_of_the_nearest() -> None:
    skin = body(0)
    values = np.arange(len(skin.vertices), dtype=np.float64)
    highest = int(skin.vertices[:, 1].argmax())
    above = skin.vertices[highest] + [0.0, 50.0, 0.0]
    assert interpolate(values, skin, above[None, :]) == pytest.approx(values[highest])
