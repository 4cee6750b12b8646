import numpy as np
import pytest

from core.geometry.exact_intersection import find_intersecting_faces, find_intersecting_faces_between
from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from subjects.body import body
from tests.solids import cube, sphere, tetrahedron

# name: (vertices, faces, does the pair meet other than in shared corners and edges)
TWO_FACES = {
    "apart": ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]], [[0, 1, 2], [3, 4, 5]], False),
    "side through face": ([[0, 0, 0], [3, 0, 0], [0, 3, 0], [1, 1, -1], [1, 1, 1], [5, 5, 0]], [[0, 1, 2], [3, 4, 5]], True),
    "corner on face": ([[0, 0, 0], [3, 0, 0], [0, 3, 0], [1, 1, 0], [1, 1, 1], [2, 1, 1]], [[0, 1, 2], [3, 4, 5]], True),
    "corner on side": ([[0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 0, 0], [1, -1, 1], [2, -1, 1]], [[0, 1, 2], [3, 4, 5]], True),
    "flat neighbours": ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0]], [[0, 1, 2], [1, 0, 3]], False),
    "folded over flat": ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 0, 3]], True),
    "folded over flat, tip on a side": ([[0, 0, 0], [2, 0, 1], [0, 2, 4], [0, 1, 2]], [[0, 1, 2], [1, 0, 3]], True),
    "folded over flat, askew": (
        [[0, 0, 0], [4.0231, -4.2275, 20.491], [3.3572, -17.139, 11.572], [1.6786, -8.5695, 5.786]],
        [[0, 1, 2], [1, 0, 3]],
        True,
    ),
    "folded almost flat": ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1e-300]], [[0, 1, 2], [1, 0, 3]], False),
    "corner shared, side through": ([[0, 0, 0], [2, -1, 0], [2, 1, 0], [2, 0, -1], [2, 0, 1]], [[0, 1, 2], [0, 3, 4]], True),
    "corner shared, flat overlap": ([[0, 0, 0], [2, -1, 0], [2, 1, 0], [1, 0, 0], [1, 0.1, 0]], [[0, 1, 2], [0, 3, 4]], True),
    "corner shared, flat apart": ([[0, 0, 0], [2, -1, 0], [2, 1, 0], [-1, 0, 0], [-1, 1, 0]], [[0, 1, 2], [0, 3, 4]], False),
    "one flat inside the other": (
        [[0, 0, 0], [9, 0, 0], [0, 9, 0], [1, 1, 0], [2, 1, 0], [1, 2, 0]],
        [[0, 1, 2], [3, 4, 5]],
        True,
    ),
    "doubled": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 1, 2]], True),
    "doubled the other way round": ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [2, 1, 0]], True),
    "doubled with other vertices": (
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0]],
        [[0, 1, 2], [4, 3, 5]],
        True,
    ),
    "touching at an equal point": (
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [-1, 0, 1], [0, -1, 1]],
        [[0, 1, 2], [3, 4, 5]],
        False,
    ),
}


@pytest.mark.parametrize("name", TWO_FACES)
def test_two_faces(name):
    vertices, faces, meet = TWO_FACES[name]
    mesh = Mesh.of(vertices, faces)
    assert find_intersecting_faces(mesh.vertices, mesh.faces).tolist() == ([[0, 1]] if meet else [])


def test_pairs_are_sorted_and_the_same_every_time():
    vertices = body().vertices - 3.0 * vertex_normals(body().vertices, body().faces)
    pairs = find_intersecting_faces(vertices, body().faces)
    assert len(pairs) > 1000
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert np.array_equal(pairs, np.unique(pairs, axis=0))
    assert np.array_equal(pairs, find_intersecting_faces(vertices, body().faces))


def test_body_is_free_of_intersections():
    assert find_intersecting_faces(body().vertices, body().faces).shape == (0, 2)


def test_between_two_tetrahedra():
    # the corner of b at (0.2, 0.2, -0.5)+ sticks through the bottom face of a: sides along z of b cross it
    a, b = tetrahedron(), tetrahedron(0.2, at=(0.2, 0.2, -0.1))
    pairs = find_intersecting_faces_between(a, b)
    assert pairs.tolist() == [[0, 1], [0, 2], [0, 3]]
    assert find_intersecting_faces_between(b, a).tolist() == [[1, 0], [2, 0], [3, 0]]


def test_between_nested_and_between_touching():
    assert len(find_intersecting_faces_between(sphere(2.0), sphere(1.0))) == 0
    # equal corners are taken for shared ones; of the common square each half meets its double and nothing else
    assert find_intersecting_faces_between(cube(), cube(at=(1.0, 0.0, 0.0))).tolist() == [[2, 1], [3, 0]]
