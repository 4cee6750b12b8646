"""Contacts of two surfaces against distances of every pair of their faces."""

import numpy as np
import pytest

from core.geometry.containment import is_inside
from core.geometry.distance import closest_points
from core.geometry.face_tree import FaceTree
from core.separation.contacts import COINCIDENT_MM, find_contacts
from core.separation.opening import find_wrong
from core.separation.sides import are_faces_inside, are_vertices_inside
from core.separation.tissue import Tissue
from tests.solids import cube, sphere, together


def tree(mesh):
    return FaceTree.of(mesh.vertices.copy(), mesh.faces)


def test_faces_closer_than_the_limit_on_both_sides():
    a, b = cube(10.0), cube(10.0, at=(10.3, 0.0, 0.0))
    of_a, of_b = find_contacts(tree(a), tree(b), 0.5)
    for mesh, other, contacts in ((a, b, of_a), (b, a, of_b)):
        corner_distance = closest_points(other.vertices, other.faces, mesh.vertices)[0]
        near = np.flatnonzero((corner_distance[mesh.faces] < 0.5).any(axis=1))
        np.testing.assert_array_equal(contacts.faces, near)
        np.testing.assert_allclose(contacts.distance_mm, 0.3)
        np.testing.assert_allclose(contacts.points[:, 0], 10.15)


def test_crossing_faces_are_at_distance_nought():
    of_a, of_b = find_contacts(tree(cube(10.0)), tree(cube(10.0, at=(9.0, 3.0, 2.0))), 0.01)
    assert len(of_a.faces) > 0
    assert len(of_b.faces) > 0
    assert not of_a.distance_mm.any()


def test_nothing_near_is_no_contact():
    of_a, of_b = find_contacts(tree(sphere(5.0, 3)), tree(sphere(4.0, 3)), 0.5)
    assert len(of_a.faces) == len(of_b.faces) == 0


@pytest.mark.parametrize("shift", [0.0, 1.5, 3.7, 9.0, 20.0])
def test_sides_of_parts_are_those_of_every_point(shift):
    a, b = together(sphere(5.0, 3), sphere(1.0, 2, at=(9.0, 0.0, 0.0))), sphere(4.0, 3, at=(shift, 0.13, 0.07))
    other = tree(b)
    contacts, _ = find_contacts(tree(a), other, COINCIDENT_MM)
    vertices, middles = a.vertices.copy(), a.triangles().mean(axis=1)
    np.testing.assert_array_equal(are_vertices_inside(vertices, a.faces, other, contacts.faces), is_inside(other, vertices))
    np.testing.assert_array_equal(are_faces_inside(vertices, a.faces, other, contacts.faces), is_inside(other, middles))


def test_a_piece_on_the_wrong_side_is_seen_though_nothing_is_near():
    meshes = {"skin": sphere(5.0, 2), "organ": sphere(1.0, 2, at=(20.0, 0.0, 0.0))}
    tissues = {name: Tissue.of(name, mesh, 0, 0.1, movable=True) for name, mesh in meshes.items()}
    wrong = find_wrong(tissues, {("organ", "skin"): "inside", ("skin", "organ"): "around"})
    assert len(wrong["organ", "skin"]) == len(meshes["organ"].vertices)
    assert len(wrong["skin", "organ"]) == 0
