"""OpenMEEG itself reads what we write, finds it nested, and computes the potential of a dipole as the closed form has it."""

from __future__ import annotations

import numpy as np
import openmeeg
import pytest
from scipy.special import eval_legendre

from core.package.openmeeg import conductivities_text, geometry_text, triangles_text, write_model
from core.package.tissue import FREE_SPACE, Tissue
from tests.core.package.nested import tissues
from tests.solids import sphere

RADII = (100.0, 92.0, 86.0)  # outermost first
SIGMA = (0.465, 0.010, 0.275)
DIPOLE = 40.0  # distance to the middle
RDM = 0.03  # difference of the shapes; 0.021 with these 128 faces a sphere, 0.0038 with 512
MAG_OFF = 0.1  # of the ratio of sizes from 1: 0.080, 0.022


@pytest.fixture(scope="module")
def head(tmp_path_factory):
    names = ("skin", "skull", "brain")
    made = [
        Tissue(name, sphere(radius, 2).rounded_to_float32(), None, sigma, enclosing)
        for name, radius, sigma, enclosing in zip(names, RADII, SIGMA, (FREE_SPACE, *names), strict=False)
    ]
    folder = tmp_path_factory.mktemp("openmeeg")
    write_model(folder, made)
    return folder


def read(folder):
    return openmeeg.read_geometry(str(folder / "model.geom"), str(folder / "model.cond"))


def test_its_reader_finds_the_surfaces_nested_and_turns_none(head, capfd):
    geometry = read(head)
    assert geometry.is_nested()
    assert geometry.selfCheck()
    assert "reorientation" not in capfd.readouterr().out


def test_its_reader_gets_every_vertex_bit_for_bit(head):
    lines = (head / "skin.tri").read_text().splitlines()
    count = int(lines[0].split()[1])
    read_back = np.array([line.split()[:3] for line in lines[1 : count + 1]], dtype=np.float32)
    np.testing.assert_array_equal(read_back, sphere(RADII[0], 2).rounded_to_float32().vertices.astype(np.float32))


def test_its_solution_is_that_of_three_spheres(head):
    geometry = read(head)
    angles = np.linspace(0.0, np.pi, 19)
    sensors = RADII[0] * np.column_stack([np.sin(angles), np.zeros(19), np.cos(angles)])
    dipole = openmeeg.Matrix(np.array([[0.0, 0.0, DIPOLE, 0.0, 0.0, 1.0]], order="F"))
    inverse = openmeeg.HeadMat(geometry)
    inverse.invert()
    source = openmeeg.DipSourceMat(geometry, dipole, "")
    placed = openmeeg.Sensors(openmeeg.Matrix(np.asfortranarray(sensors)), geometry)
    potential = openmeeg.GainEEG(inverse, source, openmeeg.Head2EEGMat(geometry, placed)).array()[:, 0]
    expected = _three_spheres(angles)
    potential, expected = potential - potential.mean(), expected - expected.mean()
    sizes = np.linalg.norm(potential), np.linalg.norm(expected)
    rdm, mag = np.linalg.norm(potential / sizes[0] - expected / sizes[1]), sizes[0] / sizes[1]
    assert rdm < RDM
    assert abs(mag - 1) < MAG_OFF


def _three_spheres(angles):
    """Potential on the outermost of concentric spheres of a radial unit dipole: Legendre series, continuity layer by layer."""
    total = np.zeros_like(angles)
    radii, sigma = RADII[::-1], SIGMA[::-1]
    for n in range(1, 80):
        # r^n and r^-(n+1) parts per layer: (source fixed, response unknown) carried outwards as a linear map
        source = np.array([0.0, n * (DIPOLE / RADII[0]) ** (n - 1) / (4 * np.pi * sigma[0])])
        response = np.array([1.0, 0.0])
        for radius, inner, outer in zip(radii, sigma, sigma[1:], strict=False):
            x = radius / RADII[0]
            values = np.array([[x**n, x ** -(n + 1)], [n * x ** (n - 1), -(n + 1) * x ** -(n + 2)]])
            carry = np.linalg.solve(values, np.diag([1.0, inner / outer]) @ values)
            source, response = carry @ source, carry @ response
        slope = np.array([n, -(n + 1)])  # no current leaves the outermost sphere
        amount = -(slope @ source) / (slope @ response)
        total += (source + amount * response).sum() / RADII[0] ** 2 * eval_legendre(n, np.cos(angles))
    return total


def test_siblings_share_the_domain_around_them():
    outer, left, right = (
        Tissue(name, tissues()[0].mesh, None, 0.1, around)
        for name, around in (("skin", FREE_SPACE), ("left", "skin"), ("right", "skin"))
    )
    text = geometry_text([outer, left, right])
    assert "Domain Air: +skin\n" in text
    assert "Domain skin: -skin +left +right\n" in text
    assert "Domain left: -left\n" in text
    assert conductivities_text([outer]).splitlines()[-2:] == ["Air 0.0", "skin 0.1"]


def test_normals_point_outwards():
    mesh = sphere(10.0, 1)
    rows = triangles_text(mesh).splitlines()[1 : len(mesh.vertices) + 1]
    numbers = np.array([row.split() for row in rows], dtype=float)
    assert (np.einsum("ij,ij->i", numbers[:, :3], numbers[:, 3:]) > 9.0).all()
