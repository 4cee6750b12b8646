"""Numbers of before and after against closed forms."""

import numpy as np
import pytest

from core.geometry.deviation import measure_deviation
from core.mesh import Mesh
from core.schema.report import ComparisonReport
from core.validation.comparison import compare_with_original, count_kept_vertices
from core.validation.validate import validate
from tests.solids import cube, without_faces


def compared(original: Mesh, result: Mesh) -> ComparisonReport:
    before, after = (validate({"mesh": mesh}).meshes["mesh"] for mesh in (original, result))
    return compare_with_original(original, before, result, after, measure_deviation(original, result))


def test_a_grown_cube() -> None:
    original = cube(10.0)
    low = original.vertices.min(axis=0)
    result = original.with_vertices(low + 1.1 * (original.vertices - low))
    found = compared(original, result)
    assert found.volume_change == pytest.approx(1.1**3 - 1)
    assert found.area_change == pytest.approx(1.1**2 - 1)
    assert found.kept_vertices == 1
    # the corner opposite the fixed one moves by (1, 1, 1) away from the old corner, the nearest point of the old cube
    assert found.deviation.maximum_mm == pytest.approx(np.sqrt(3.0))
    assert found.deviation.to_original_mm == found.deviation.maximum_mm
    assert found.deviation.from_original_mm < found.deviation.maximum_mm
    assert found.deviation.at_mm == pytest.approx(tuple(low + 11.0))


def test_an_open_surface_has_no_volume_to_compare() -> None:
    assert compared(cube(10.0), without_faces(cube(10.0), [0])).volume_change is None


def test_only_equal_bits_are_kept() -> None:
    vertices = np.array([[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [-0.0, 0.0, 0.0]])
    assert count_kept_vertices(vertices, vertices[[2, 0]]) == 2
    assert count_kept_vertices(vertices, np.array([[0.0, 0.0, 0.0]])) == 1
    assert count_kept_vertices(vertices, np.nextafter(vertices, np.inf)) == 0
