"""Means over rings and steps made of them, against hands and eigenvalues."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.adjacency import edges, vertex_neighbours
from core.geometry.laplacian import laplacian_step, neighbour_means, taubin_step
from tests.solids import octahedron, sphere, tetrahedron


def _rings(mesh):
    return vertex_neighbours(edges(mesh.faces).ends, len(mesh.vertices))


def test_mean_of_a_tetrahedrons_other_corners():
    mesh = tetrahedron(3.0)
    means = neighbour_means(mesh.vertices, _rings(mesh), np.array([0, 3]))
    assert means == pytest.approx(np.array([[1.0, 1.0, 1.0], [1.0, 1.0, 0.0]]))


def test_vertex_without_neighbours_keeps_its_row():
    mesh = tetrahedron()
    field = np.vstack((mesh.vertices, [[7.0, 8.0, 9.0]]))
    rings = vertex_neighbours(edges(mesh.faces).ends, 5)
    assert neighbour_means(field, rings, np.array([4])) == pytest.approx(field[4:])


def test_step_moves_the_chosen_and_all_of_them_at_once():
    # in an octahedron the neighbours' mean is the centre, whichever vertex moves first if they move one after another
    mesh = octahedron(2.0)
    stepped = laplacian_step(mesh.vertices, _rings(mesh), np.arange(5), 0.25)
    assert stepped[:5] == pytest.approx(0.75 * mesh.vertices[:5])
    assert (stepped[5] == mesh.vertices[5]).all()


def test_simultaneous_step_is_the_matrix_of_the_rings():
    mesh = sphere(10.0, 1)
    ends = edges(mesh.faces).ends
    adjacency = np.zeros((len(mesh.vertices),) * 2)
    adjacency[ends[:, 0], ends[:, 1]] = adjacency[ends[:, 1], ends[:, 0]] = 1.0
    walk = adjacency / adjacency.sum(axis=1, keepdims=True)
    everything = np.arange(len(mesh.vertices))
    assert laplacian_step(mesh.vertices, _rings(mesh), everything, 0.3) == pytest.approx(
        0.7 * mesh.vertices + 0.3 * walk @ mesh.vertices
    )


def test_taubin_scales_each_wave_by_its_transfer_function():
    # the vertices of an octahedron are waves with eigenvalue 1: mean of the ring 0, so (1 - λ)(1 - μ)
    mesh = octahedron()
    stepped = taubin_step(mesh.vertices, _rings(mesh), np.arange(6), 0.5, -0.53)
    assert stepped == pytest.approx((1 - 0.5) * (1 + 0.53) * mesh.vertices)
