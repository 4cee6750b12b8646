"""Two-sided deviation against closed forms."""

import numpy as np
import pytest

from core.geometry.deviation import measure_deviation
from core.mesh import Mesh
from tests.solids import sphere, together


def square(height: float, tip: float = 0.0) -> Mesh:
    """2 × 2 mm at a height, its middle lifted by `tip`."""
    corners = [(-1, -1, height), (1, -1, height), (1, 1, height), (-1, 1, height), (0, 0, height + tip)]
    return Mesh.of(corners, [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])


def test_equal_surfaces_do_not_deviate() -> None:
    deviation = measure_deviation(sphere(10, 2), sphere(10, 2))
    assert deviation.rms_mm <= deviation.maximum_mm < 1e-12


def test_parallel_sheets_deviate_by_their_distance() -> None:
    deviation = measure_deviation(square(0.0), square(0.25))
    assert deviation.maximum_mm == deviation.rms_mm == 0.25
    assert deviation.farthest()[2] in (0.0, 0.25)


def test_what_only_one_of_them_has_counts() -> None:
    whole = together(sphere(10, 2), sphere(1, 1, at=(0, 0, 14)))
    deviation = measure_deviation(whole, sphere(10, 2))
    assert deviation.back.maximum_mm < 1e-12
    assert 4.9 < deviation.forth.maximum_mm == deviation.maximum_mm <= 5.1
    assert deviation.farthest()[2] == pytest.approx(15.0, abs=0.1)
    assert (deviation.forth.per_face()[: len(sphere(10, 2).faces)] < 1e-12).all()


def test_the_root_mean_square_of_a_pyramid() -> None:
    """Its sheet is a plane: heights run linearly from 0 at the rim to h at the tip, the mean square over a triangle is h²/6."""
    pyramid = square(0.0, 0.3)
    way = measure_deviation(pyramid, square(0.0)).forth
    assert np.sqrt((way.mean_square() * way.areas).sum() / way.areas.sum()) == pytest.approx(0.3 / np.sqrt(6.0))


def test_vertices_without_faces_are_no_surface() -> None:
    stray = Mesh.of([*square(0.0).vertices, (0, 0, 50)], square(0.0).faces)
    assert measure_deviation(stray, square(0.0)).maximum_mm == 0.0
