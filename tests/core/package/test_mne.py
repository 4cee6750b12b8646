"""MNE-Python takes the surfaces of a package as README.txt tells, and itself decides whether they nest."""

from __future__ import annotations

import mne
import numpy as np
import pytest
import scipy.io

from core.io.registry import write_mesh
from core.package.tissue import FREE_SPACE, Tissue
from tests.solids import sphere

TISSUES = tuple(  # of the size of a head: it doubts smaller ones
    Tissue(name, sphere(radius, 2, at=(0.1, 0.2, 0.3)).rounded_to_float32(), None, sigma, enclosing)
    for name, radius, sigma, enclosing in (
        ("skin", 95.0, 0.465, FREE_SPACE),
        ("skull", 86.0, 0.01, "skin"),
        ("csf", 80.0, 1.654, "skull"),
    )
)
FILES = ("outer_skin", "outer_skull", "inner_skull")  # names that MNE looks for, outermost first


@pytest.fixture
def subject(tmp_path):
    """A subject whose surfaces are those of three tissues, from the MAT files as a package has them."""
    (tmp_path / "body" / "bem").mkdir(parents=True)
    for name, tissue in zip(FILES, TISSUES, strict=True):
        write_mesh(tissue.mesh, tmp_path / f"{tissue.name}.mat", "mat", tissue.name)
        surface = scipy.io.loadmat(tmp_path / f"{tissue.name}.mat")
        save(tmp_path, name, surface["P"], surface["t"].astype(int) - 1)
    return tmp_path


def save(folder, name, vertices_mm, faces):
    mne.write_surface(folder / "body" / "bem" / f"{name}.surf", vertices_mm, faces, overwrite=True, verbose="ERROR")


def model(folder, sigma):
    """sigma: S/m from the inside outwards, as MNE counts."""
    return mne.make_bem_model("body", ico=None, conductivity=sigma, subjects_dir=folder, verbose="ERROR")


def test_three_layers_are_nested_to_it_and_can_be_solved(subject):
    sigma = tuple(tissue.conductivity_s_per_m for tissue in reversed(TISSUES))
    made = model(subject, sigma)
    for surface, tissue in zip(made, TISSUES, strict=True):
        assert surface["sigma"] == tissue.conductivity_s_per_m
        np.testing.assert_allclose(1000 * surface["rr"], tissue.mesh.vertices, atol=1e-5)  # its unit is m, its file float32
        np.testing.assert_array_equal(surface["tris"], tissue.mesh.faces)
    solution = mne.make_bem_solution(made, verbose="ERROR")["solution"]
    assert solution.shape == (3 * 66, 3 * 66)
    assert np.isfinite(solution).all()


def test_one_layer_is_taken_and_two_are_not(subject):
    assert len(model(subject, (0.3,))) == 1
    with pytest.raises(ValueError, match="1 or 3 elements"):
        model(subject, (0.3, 0.1))


def test_it_would_tell_a_layer_that_sticks_out(subject):
    wide = sphere(90.0, 2, at=(0.1, 0.2, 0.3))
    save(subject, "inner_skull", wide.vertices, wide.faces)
    with pytest.raises(RuntimeError, match="inner skull is not completely inside surface outer skull"):
        model(subject, (0.3, 0.1, 0.3))


def test_it_would_tell_a_hole(subject):
    tissue = TISSUES[2]
    save(subject, "inner_skull", tissue.mesh.vertices, tissue.mesh.faces[1:])
    with pytest.raises(RuntimeError, match="not complete"):
        model(subject, (0.3, 0.1, 0.3))
