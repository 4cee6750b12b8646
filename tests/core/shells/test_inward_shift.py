"""Eq. (4.1): moving a vertex shifts the faces around it by exactly the distance asked for."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.adjacency import vertex_faces
from core.geometry.normals import face_normals, mean_normals
from core.shells.inward_shift import LONGEST_SHIFT, inward_shift
from subjects.body import body
from tests.core.shells.solids import cone, cube


@pytest.mark.parametrize("half_angle_deg", [20.0, 45.0, 70.0])
@pytest.mark.parametrize("sides", [5, 8, 31])
def test_cone_faces_shift_by_exactly_the_distance(half_angle_deg, sides):
    mesh = cone(half_angle_deg, sides)
    shift = inward_shift(mesh.vertices, mesh.faces, vertex_faces(mesh.faces, len(mesh.vertices)))
    flank_normals = face_normals(mesh.vertices, mesh.faces)[:sides]
    assert flank_normals @ shift[0] == pytest.approx(-1.0, abs=1e-3)


@pytest.mark.parametrize("half_angle_deg", [30.0, 60.0])
def test_at_a_cone_it_is_the_equation_of_the_thesis(half_angle_deg):
    mesh = cone(half_angle_deg, 24)
    shift = inward_shift(mesh.vertices, mesh.faces, vertex_faces(mesh.faces, len(mesh.vertices)))
    n0 = mean_normals(mesh.vertices, mesh.faces, "inverse_area")[0]
    assert shift[0] == pytest.approx(-n0 / (n0 @ n0), abs=2e-3)


def test_corner_of_a_cube_moves_along_its_diagonal():
    mesh = cube()
    shift = inward_shift(mesh.vertices, mesh.faces, vertex_faces(mesh.faces, len(mesh.vertices)))
    assert shift == pytest.approx(-np.sign(mesh.vertices), abs=1e-3)


def test_every_face_of_the_body_shifts_by_at_least_the_distance():
    mesh = body(0)
    shift = inward_shift(mesh.vertices, mesh.faces, vertex_faces(mesh.faces, len(mesh.vertices)))
    normals = face_normals(mesh.vertices, mesh.faces)
    shifted = -np.einsum("fi,fci->fc", normals, shift[mesh.faces])
    assert shifted.min() > 0.99
    assert np.linalg.norm(shift, axis=1).max() <= LONGEST_SHIFT
