"""Fields on the triangles of a surface: exact where they can be, never guessed where they cannot."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from core.errors import InputError
from core.field_source import FieldData, FieldMesh
from core.fields.asked_columns import FieldPoints
from core.fields.field_reader import FieldReader, choose_data
from core.fields.no_overlap import no_overlap
from core.fields.statistics import measure_field
from core.geometry.normals import face_normals
from core.mesh import Mesh
from core.schema.fields import FieldParameters
from subjects.figure_eight import above_head, figure_eight, primary_field
from subjects.fsaverage import fsaverage
from tests.solids import cube
from tests.solids import sphere as sphere_of

Floats = NDArray[np.float64]
ASKED = FieldParameters()


def linear(points: Floats) -> Floats:
    field: Floats = np.column_stack([points[:, 0], 2.0 * points[:, 1] - 1.0, points[:, 2] + points[:, 0]])
    return field


def as_points(points: Floats, values: Floats) -> FieldPoints:
    return FieldPoints(points, values, len(points), 0, 0)


def around(surface: Mesh) -> tuple[Floats, NDArray[np.int32]]:
    """Nodes of tetrahedra that fill a box around a surface, not made of it."""
    low, high = surface.vertices.min(axis=0) - 2.0, surface.vertices.max(axis=0) + 2.0
    axes = [np.linspace(low[axis], high[axis], 7) for axis in range(3)]
    nodes = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    nodes += np.random.default_rng(4).uniform(-0.05, 0.05, nodes.shape)
    return nodes, Delaunay(nodes).simplices.astype(np.int32)


def on_triangles(surface: Mesh, values: Floats, where: str = "elements") -> FieldMesh:
    data = FieldData("E", where, values)  # type: ignore[arg-type]
    return FieldMesh(surface.vertices, surface.faces, np.empty((0, 4), np.int32), (data,))


def test_values_at_the_corners_give_their_mean_on_a_real_head() -> None:
    """The primary field of a coil above it, in closed form."""
    head = fsaverage("head")
    coil = figure_eight().placed(above_head(head.vertices[head.vertices[:, 2].argmax()]))
    values = primary_field(coil, head.vertices)
    order = np.random.default_rng(5).permutation(len(values))
    mapped = FieldReader(as_points(head.vertices[order], values[order]), ASKED).map_onto(head)
    np.testing.assert_allclose(mapped.values, values[head.faces].mean(axis=1), rtol=1e-12)
    assert mapped.distance_mm.max() == 0.0
    assert "corners" in mapped.method
    # and the mean of the corners is the field itself but for the curvature of the field over a triangle of 10 mm
    middle = primary_field(coil, head.triangles().mean(axis=1))
    error = np.linalg.norm(mapped.values - middle, axis=1)
    assert np.percentile(error / np.linalg.norm(middle, axis=1).max(), 99) < 0.05


def test_values_at_the_centres_are_taken_as_they_are() -> None:
    sphere = sphere_of(30.0, 2)
    centres = sphere.triangles().mean(axis=1)
    values = linear(centres)
    mapped = FieldReader(as_points(centres, values), ASKED).map_onto(sphere)
    np.testing.assert_array_equal(mapped.values, values)
    assert "centre" in mapped.method


def test_scattered_points_are_weighted_and_their_distance_told() -> None:
    sphere = sphere_of(30.0, 2)
    points = np.random.default_rng(6).uniform(-32, 32, (40_000, 3))
    mapped = FieldReader(as_points(points, linear(points)), ASKED).map_onto(sphere)
    assert "inverse square" in mapped.method
    exact = linear(sphere.triangles().mean(axis=1))
    assert np.abs(mapped.values - exact).max() < 2.5  # points lie 1.2 mm from each other, the slope is 2 per mm
    assert 0.0 < mapped.distance_mm.max() < 3.0
    nearest = FieldReader(as_points(points, linear(points)), FieldParameters(method="nearest")).map_onto(sphere)
    assert np.abs(nearest.values - exact).mean() > np.abs(mapped.values - exact).mean()


def test_a_linear_field_at_nodes_of_tetrahedra_is_exact() -> None:
    sphere = sphere_of(30.0, 2)
    nodes, tetrahedra = around(sphere)
    mesh = FieldMesh(nodes, np.empty((0, 3), np.int32), tetrahedra, (FieldData("E", "nodes", linear(nodes)),))
    mapped = FieldReader(mesh, ASKED).map_onto(sphere)
    # 0.001 mm below the triangle
    np.testing.assert_allclose(mapped.values, linear(sphere.triangles().mean(axis=1)), atol=0.0021)
    assert (mapped.distance_mm == 0.0).all()
    deeper = FieldReader(mesh, FieldParameters(inward_mm=2.0)).map_onto(sphere)
    centres = sphere.triangles().mean(axis=1)
    below = centres - 2.0 * face_normals(sphere.vertices, sphere.faces)
    np.testing.assert_allclose(deeper.values, linear(below), rtol=1e-9, atol=1e-9)


def test_between_two_tissues_the_inner_one_counts() -> None:
    """A box within a box of the same mesh: the field jumps on the inner surface, and rounding may not choose the side."""
    inner = cube(10.0)
    low = inner.vertices.min(axis=0)
    axes = [np.array([low[axis] - 5, low[axis], low[axis] + 10, low[axis] + 15]) for axis in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    tetrahedra = Delaunay(nodes).simplices.astype(np.int32)
    middles = nodes[tetrahedra].mean(axis=1)
    inside = (np.abs(middles - (low + 5)) < 5).all(axis=1)
    data = FieldData("magnE", "elements", np.where(inside, 1.0, 2.0)[:, None])
    mapped = FieldReader(FieldMesh(nodes, np.empty((0, 3), np.int32), tetrahedra, (data,)), ASKED).map_onto(inner)
    assert (mapped.values == 1.0).all()


@pytest.mark.parametrize("where", ["elements", "nodes"])
def test_triangles_of_the_surface_itself_have_their_own_values(where: str) -> None:
    sphere = sphere_of(30.0, 2)
    values = linear(sphere.triangles().mean(axis=1) if where == "elements" else sphere.vertices)
    mapped = FieldReader(on_triangles(sphere, values, where), ASKED).map_onto(sphere)
    expected = values if where == "elements" else values[sphere.faces].mean(axis=1)
    np.testing.assert_allclose(mapped.values, expected, rtol=1e-9, atol=1e-9)


def test_triangles_too_far_have_no_value() -> None:
    sphere = sphere_of(30.0, 2)
    above = sphere.vertices[:, 2] > 0
    points = sphere.vertices[above]
    asked = FieldParameters(method="nearest", max_distance_mm=8.0)
    mapped = FieldReader(as_points(points, np.ones((len(points), 1))), asked).map_onto(sphere)
    far = mapped.too_far
    np.testing.assert_array_equal(far, mapped.distance_mm > 8.0)
    assert 0 < far.sum() < len(far)
    assert np.isnan(mapped.magnitude[far]).all()
    assert (mapped.magnitude[~far] == 1.0).all()
    report = measure_field(sphere, mapped)
    assert (report.too_far, report.normal) == (int(far.sum()), None)


def test_numbers_are_weighted_by_area_and_parts_are_apart() -> None:
    box = cube(10.0)
    normals = np.array([[0.0, 0.0, 3.0]] * len(box.faces))
    report = measure_field(box, FieldReader(on_triangles(box, normals), ASKED).map_onto(box))
    assert report.magnitude is not None
    assert report.normal is not None
    assert report.tangential is not None
    assert report.magnitude.mean == pytest.approx(3.0)
    assert report.normal.mean == pytest.approx(1.0)  # 3 V/m through two of six sides
    assert report.tangential.mean == pytest.approx(2.0)
    assert report.area_with_value_mm2 == pytest.approx(600.0)


def test_units_of_the_field() -> None:
    box = cube(10.0)
    mapped = FieldReader(on_triangles(box, np.ones((len(box.faces), 3))), FieldParameters(field_unit="V/mm")).map_onto(box)
    np.testing.assert_allclose(mapped.values, 1000.0)


def test_a_table_has_no_elements() -> None:
    with pytest.raises(InputError) as caught:
        FieldReader(as_points(np.zeros((1, 3)), np.ones((1, 1))), FieldParameters(method="containing"))
    assert caught.value.code == "fields.method_unfit"


def test_which_data_is_the_field() -> None:
    box = cube(10.0)

    def mesh(*names: str) -> FieldMesh:
        data = tuple(FieldData(name, "elements", np.ones((len(box.faces), 1))) for name in names)
        return FieldMesh(box.vertices, box.faces, np.empty((0, 4), np.int32), data)

    assert choose_data(mesh("v", "magnE", "E"), None).name == "E"
    assert choose_data(mesh("v", "magnE"), None).name == "magnE"
    assert choose_data(mesh("J"), None).name == "J"
    assert choose_data(mesh("E", "J"), "J").name == "J"
    for names, wanted in ((("J", "v"), None), (("E",), "J")):
        with pytest.raises(InputError, match="the file has") as caught:
            choose_data(mesh(*names), wanted)
        assert caught.value.code == "fields.data_unknown"


@pytest.mark.parametrize(
    ("factor", "hint"), [(0.001, "is in m,"), (0.1, "is in cm,"), (1 / 25.4, "inches"), (3.0, "same coordinates")]
)
def test_units_that_do_not_fit_are_guessed(factor: float, hint: str) -> None:
    sphere = sphere_of(90.0, 1)
    error = no_overlap([sphere], factor * sphere.vertices, 5.0)
    assert error.code == "fields.no_overlap"
    assert hint in error.message
