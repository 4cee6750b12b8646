import numpy as np
import pytest

from core.geometry.volume import signed_volumes
from tests.solids import cube, flipped, octahedron, sphere, tetrahedron, together, torus


def volume(mesh):
    return signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0]


def test_closed_forms():
    assert volume(cube(3.0)) == pytest.approx(27.0)
    assert volume(tetrahedron(2.0)) == pytest.approx(8 / 6)
    assert volume(octahedron(2.0)) == pytest.approx(4 / 3 * 8)
    assert volume(flipped(cube(3.0))) == pytest.approx(-27.0)


def test_far_away_the_volume_stays():
    assert volume(cube(1.0, at=(1e6, -1e6, 1e6))) == pytest.approx(1.0, rel=1e-9)


def test_curved_solids_come_near_their_formula_from_below():
    for mesh, exact in ((sphere(1.0, 4), 4 / 3 * np.pi), (torus(3.0, 1.0, 96, 64), 2 * np.pi**2 * 3)):
        assert 0.99 * exact < volume(mesh) < exact


def test_pieces_are_kept_apart():
    mesh = together(cube(2.0), flipped(tetrahedron(1.0, at=(9, 9, 9))))
    assert signed_volumes(mesh.vertices, mesh.faces, np.repeat([0, 1], [12, 4])) == pytest.approx([8.0, -1 / 6])
