import numpy as np
import pytest

from core.geometry.normals import corner_angles, face_areas, face_normals, mean_normals, vertex_normals
from tests.solids import cube, sphere, tetrahedron


def test_faces_of_a_cube_look_along_the_axes():
    mesh = cube(2.0)
    normals = face_normals(mesh.vertices, mesh.faces)
    outward = np.sign(mesh.triangles().mean(axis=1) - 1.0) * np.isclose(np.abs(mesh.triangles().mean(axis=1) - 1.0), 1.0)
    assert normals == pytest.approx(outward)
    assert face_areas(mesh.vertices, mesh.faces).tolist() == [2.0] * 12


def test_corner_angles_add_up():
    mesh = tetrahedron()
    angles = np.degrees(corner_angles(mesh.vertices, mesh.faces))
    assert angles.sum(axis=1) == pytest.approx(180.0)
    assert sorted(angles[0]) == pytest.approx([45, 45, 90])
    assert angles[2] == pytest.approx(60.0)


def test_angle_weights_do_not_see_how_a_cube_is_cut():
    mesh = cube(2.0)
    expected = (mesh.vertices - 1.0) / np.sqrt(3)
    assert vertex_normals(mesh.vertices, mesh.faces) == pytest.approx(expected)


def test_inverse_area_mean_is_equation_4_1():
    mesh = tetrahedron()
    # corner 0 touches three right-angled faces of equal area: n0 = -(1, 1, 1) / 3
    n0 = mean_normals(mesh.vertices, mesh.faces, "inverse_area")[0]
    assert n0 == pytest.approx([-1 / 3] * 3)
    # corner 1: faces z=0, y=0 (area 1/2) and the slanted one (area sqrt(3)/2)
    weights = np.array([2.0, 2.0, 2 / np.sqrt(3)])
    normals = np.array([[0, 0, -1], [0, -1, 0], np.ones(3) / np.sqrt(3)])
    assert mean_normals(mesh.vertices, mesh.faces, "inverse_area")[1] == pytest.approx(weights @ normals / weights.sum())


@pytest.mark.parametrize("weighting", ["area", "angle", "inverse_area"])
def test_sphere_normals_point_away_from_the_centre(weighting):
    mesh = sphere(10.0, 3)
    normals = vertex_normals(mesh.vertices, mesh.faces, weighting)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    assert np.einsum("ij,ij->i", normals, mesh.vertices / 10.0).min() > 0.999


@pytest.mark.parametrize("weighting", ["area", "angle", "inverse_area"])
def test_faces_without_area_and_lone_vertices_have_no_say(weighting):
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [9, 9, 9]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 1]], dtype=np.int32)
    assert face_normals(vertices, faces).tolist() == [[0, 0, 1], [0, 0, 0], [0, 0, 0]]
    assert vertex_normals(vertices, faces, weighting).tolist() == [[0, 0, 1]] * 3 + [[0, 0, 0]] * 2
