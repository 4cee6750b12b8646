"""Values at points, against fields whose value is known everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from core.fields.containing import NOWHERE, TetrahedronTree
from core.fields.samplers import InverseDistanceSampler, PointSampler, TetrahedronSampler, TriangleSampler

Floats = NDArray[np.float64]
SLOPE = np.array([[1.0, -2.0, 0.5], [0.0, 3.0, 1.0], [2.0, 0.0, -1.0]])


def linear(points: Floats) -> Floats:
    field: Floats = points @ SLOPE + [5.0, 6.0, 7.0]
    return field


@pytest.fixture(scope="module")
def cube() -> tuple[Floats, NDArray[np.int32]]:
    """Nodes and tetrahedra that fill the cube from 0 to 10."""
    corners = np.stack(np.meshgrid(*[[0.0, 10.0]] * 3), axis=-1).reshape(-1, 3)
    nodes = np.concatenate([corners, np.random.default_rng(1).uniform(0, 10, (60, 3))])
    return nodes, Delaunay(nodes).simplices.astype(np.int32)


def test_every_point_inside_is_found_where_it_is(cube: tuple[Floats, NDArray[np.int32]]) -> None:
    nodes, tetrahedra = cube
    points = np.random.default_rng(2).uniform(0.01, 9.99, (500, 3))
    found, weights = TetrahedronTree.of(nodes[tetrahedra]).find(points)
    assert (found != NOWHERE).all()
    assert weights.min() >= -1e-9
    np.testing.assert_allclose(np.einsum("nk,nkd->nd", weights, nodes[tetrahedra[found]]), points, atol=1e-9)


def test_points_outside_are_in_none_and_nodes_are_in_some(cube: tuple[Floats, NDArray[np.int32]]) -> None:
    nodes, tetrahedra = cube
    tree = TetrahedronTree.of(nodes[tetrahedra])
    assert (tree.find(np.array([[-0.01, 5, 5], [5, 5, 10.01], [50, 50, 50]]))[0] == NOWHERE).all()
    assert (tree.find(nodes)[0] != NOWHERE).all()


def test_flat_tetrahedra_hold_nothing() -> None:
    flat = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]])
    assert TetrahedronTree.of(flat).find(np.array([[0.3, 0.3, 0.0]]))[0][0] == NOWHERE


def test_a_linear_field_at_nodes_of_tetrahedra_is_exact(cube: tuple[Floats, NDArray[np.int32]]) -> None:
    nodes, tetrahedra = cube
    points = np.random.default_rng(3).uniform(0, 10, (200, 3))
    sampled = TetrahedronSampler(nodes, tetrahedra, linear(nodes), at_nodes=True).sample(points)
    np.testing.assert_allclose(sampled.values, linear(points), rtol=1e-9)
    assert (sampled.distance_mm == 0.0).all()


def test_outside_the_value_is_that_of_the_border_and_the_distance_says_so(cube: tuple[Floats, NDArray[np.int32]]) -> None:
    nodes, tetrahedra = cube
    inside = np.array([[10.0, 4.0, 6.0], [3.0, 0.0, 7.0]])
    outside = inside + np.array([[2.5, 0, 0], [0, -1.5, 0]])
    sampled = TetrahedronSampler(nodes, tetrahedra, linear(nodes), at_nodes=True).sample(outside)
    np.testing.assert_allclose(sampled.distance_mm, [2.5, 1.5])
    np.testing.assert_allclose(sampled.values, linear(inside), rtol=1e-9, atol=1e-9)


def test_values_of_elements_are_constant_in_them(cube: tuple[Floats, NDArray[np.int32]]) -> None:
    nodes, tetrahedra = cube
    number = np.arange(len(tetrahedra), dtype=np.float64)[:, None]
    middles = nodes[tetrahedra].mean(axis=1)
    sampled = TetrahedronSampler(nodes, tetrahedra, number, at_nodes=False).sample(middles)
    np.testing.assert_array_equal(sampled.values, number)


def test_triangles_are_asked_at_the_closest_place() -> None:
    nodes = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [10, 10, 0]])
    triangles = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
    points = np.array([[2.0, 3.0, 4.0], [9.0, 8.0, -1.0]])
    at_nodes = TriangleSampler(nodes, triangles, linear(nodes), at_nodes=True).sample(points)
    np.testing.assert_allclose(at_nodes.values, linear(points * [1, 1, 0]))
    np.testing.assert_allclose(at_nodes.distance_mm, [4.0, 1.0])
    of_triangles = TriangleSampler(nodes, triangles, np.array([[1.0], [2.0]]), at_nodes=False).sample(points)
    assert of_triangles.values.tolist() == [[1.0], [2.0]]


def test_nearest_and_weighted_points() -> None:
    points = PointSampler(np.array([[0.0, 0, 0], [2, 0, 0], [50, 0, 0]]), np.array([[10.0], [20.0], [99.0]]))
    nearest = points.sample(np.array([[0.5, 0, 0]]))
    assert (nearest.values[0, 0], nearest.distance_mm[0]) == (10.0, 0.5)
    weighted = InverseDistanceSampler(points, 2).sample(np.array([[0.5, 0, 0], [2, 0, 0]]))
    assert weighted.values[0, 0] == pytest.approx((10 / 0.25 + 20 / 2.25) / (1 / 0.25 + 1 / 2.25))
    assert weighted.values[1, 0] == 20.0  # on a point: its value
    assert weighted.distance_mm.tolist() == [0.5, 0.0]
    assert InverseDistanceSampler(points, 64).sample(np.zeros((1, 3))).values[0, 0] == 10.0  # fewer points than asked for
