"""Sections of shapes whose section is known in closed form."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.section import Contour, Plane, cut
from tests.solids import cube, flipped, sphere, together, torus, without_faces


def horizontal(height: float) -> Plane:
    return Plane.of([0, 0, height], [1, 0, 0], [0, 1, 0])


def area(contour: Contour) -> float:
    """Signed by the shoelace formula: positive if the inside is to the left."""
    x, y = contour.points.T
    return float(0.5 * (x[:-1] * y[1:] - x[1:] * y[:-1]).sum())


@pytest.mark.parametrize("height", [-0.8, -0.31, 0.0, 0.5])
def test_section_of_a_sphere_is_a_circle(height):
    (contour,) = cut(sphere(subdivisions=5), horizontal(height))
    radius = np.sqrt(1 - height**2)
    distances = np.linalg.norm(contour.points, axis=1)
    assert contour.closed
    assert radius * 0.998 < distances.min() <= distances.max() <= radius * (1 + 1e-12)
    assert 0.995 * np.pi * radius**2 < area(contour) <= np.pi * radius**2


def test_section_of_a_cube_is_its_square():
    (contour,) = cut(cube(2.0), horizontal(0.7))
    assert area(contour) == 4.0
    assert len(contour.points) == 9  # four corners, four diagonals, the first again


def test_plane_through_vertices_counts_them_as_above():
    assert cut(cube(1.0), horizontal(0.0)) == ()  # all above
    (top,) = cut(cube(1.0), horizontal(1.0))
    assert area(top) == pytest.approx(1.0)


def test_torus_gives_ring_and_hole_with_opposite_signs():
    outer, inner = cut(torus(3.0, 1.0, 64, 64), horizontal(0.01))
    assert area(outer) > 0 > area(inner)
    assert area(outer) + area(inner) == pytest.approx(np.pi * (4**2 - 2**2), rel=0.01)


def test_inside_out_mesh_runs_the_other_way():
    (contour,) = cut(flipped(cube(1.0)), horizontal(0.5))
    assert area(contour) == -1.0


def test_open_mesh_gives_an_open_contour():
    middle = horizontal(0.5)
    crossing = [face for face, corners in enumerate(cube().triangles()) if np.ptp(corners[:, 2]) > 0]
    (contour,) = cut(without_faces(cube(), crossing[:1]), middle)
    assert not contour.closed
    assert len(contour.points) == 8


def test_values_at_vertices_are_interpolated_along_the_contour():
    mesh = sphere(subdivisions=2)
    plane = Plane.of([0.1, 0.2, 0.3], [1, 2, 0], [0, 1, 3])
    for contour in cut(mesh, plane):
        at_points = plane.flatten(np.column_stack([contour.sample(mesh.vertices[:, axis]) for axis in range(3)]))
        np.testing.assert_allclose(at_points, contour.points, atol=1e-12)


@given(
    normal=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda vector: np.linalg.norm(vector) > 0.1),
    at=st.floats(-1.5, 1.5),
)
def test_every_plane_cuts_closed_surfaces_into_closed_contours_that_lie_in_it(normal, at):
    mesh = together(sphere(1.0, 2), cube(0.5, at=(1.0, 0.0, 0.0)))
    unit = np.array(normal) / np.linalg.norm(normal)
    right = np.cross(unit, np.eye(3)[int(np.argmin(np.abs(unit)))])
    plane = Plane.of(unit * at, right, np.cross(unit, right))
    crossed = np.ptp(((mesh.vertices - plane.origin) @ plane.normal >= 0)[mesh.faces].astype(int), axis=1).sum()
    contours = cut(mesh, plane)
    assert all(contour.closed for contour in contours)
    assert sum(len(contour.points) - 1 for contour in contours) == crossed
