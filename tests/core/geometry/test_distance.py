import itertools
import math
import os
import subprocess
import sys

import igl
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry import disc_bounds, distance, face_tree, triangle_distance
from core.geometry.distance import closest_points, closest_points_in, smallest_gap, smallest_gap_between
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from tests.solids import cube, sphere, tetrahedron, together

SUBSETS = [subset for size in (1, 2, 3) for subset in itertools.combinations(range(3), size)]


def gap_of_triangles(first, second):
    """Oracle: minimise over the affine hulls of all corner subsets, keep minima that lie within both triangles."""
    best = math.inf
    for of_first, of_second in itertools.product(SUBSETS, SUBSETS):
        a, b = first[list(of_first)], second[list(of_second)]
        directions = np.vstack((a[1:] - a[0], b[0] - b[1:])).T
        weights = np.linalg.lstsq(directions, b[0] - a[0], rcond=None)[0] if directions.size else np.zeros(0)
        u, v = weights[: len(a) - 1], weights[len(a) - 1 :]
        if (weights >= -1e-12).all() and u.sum() <= 1 + 1e-12 and v.sum() <= 1 + 1e-12:
            best = min(best, float(np.linalg.norm(a[0] + u @ (a[1:] - a[0]) - b[0] - v @ (b[1:] - b[0]))))
    return best


def soup(corners):
    """Triangles (N, 3, 3) that share nothing."""
    return Mesh.of(np.reshape(corners, (-1, 3)), np.arange(3 * len(corners)).reshape(-1, 3))


coordinate = st.one_of(st.integers(-2, 2).map(float), st.floats(-2, 2, allow_subnormal=False))
triangles = st.lists(st.lists(coordinate, min_size=9, max_size=9), min_size=1, max_size=4).map(
    lambda rows: np.array(rows).reshape(-1, 3, 3)
)


@given(triangles, triangles, st.sampled_from([0.0, 1.0, 5.0]))
def test_gap_agrees_with_brute_force(first, second, apart):
    second = second + np.array([apart, 0.0, 0.0])
    gap, point = smallest_gap(soup(first), soup(second))
    assert gap == pytest.approx(min(gap_of_triangles(a, b) for a in first for b in second), abs=1e-9)
    to_first = closest_points(soup(first).vertices, soup(first).faces, np.array([point]))[0]
    to_second = closest_points(soup(second).vertices, soup(second).faces, np.array([point]))[0]
    assert to_first == pytest.approx([gap / 2], abs=1e-9)
    assert to_second == pytest.approx([gap / 2], abs=1e-9)


@given(triangles, st.lists(st.lists(coordinate, min_size=3, max_size=3), min_size=1, max_size=5).map(np.array))
def test_closest_points_agree_with_libigl(corners, points):
    mesh = soup(corners)
    found, place, face = closest_points(mesh.vertices, mesh.faces, points)
    expected = np.sqrt(igl.point_mesh_squared_distance(points, mesh.vertices, mesh.faces.astype(np.int64))[0])
    assert found == pytest.approx(expected, abs=1e-7)  # libigl loses digits on slivers
    assert np.linalg.norm(place - points, axis=1) == pytest.approx(found, abs=1e-12)
    for f, p in zip(face, place, strict=True):
        assert gap_of_triangles(mesh.triangles()[f], p[None].repeat(3, axis=0)) == pytest.approx(0.0, abs=1e-9)


def test_closed_forms():
    assert smallest_gap(cube(), cube(at=(3, 0, 0))) == (2.0, (2.0, pytest.approx(0.5, abs=0.5), pytest.approx(0.5, abs=0.5)))
    assert smallest_gap(cube(), cube(at=(4, 4, 1)))[0] == pytest.approx(math.hypot(3, 3))
    # corner against corner, in all three directions
    assert smallest_gap(cube(), cube(at=(2, 3, 4))) == (pytest.approx(math.sqrt(1 + 4 + 9)), pytest.approx((1.5, 2, 2.5)))
    # crossed edges: (1, y, 1) against the edge from (2, 0, 0) + t (0, 1, 1)
    bar = soup([[[2, -5, -4], [2, 5, 6], [9, 0, 1]]])
    assert smallest_gap(cube(), bar)[0] == pytest.approx(1.0)
    assert smallest_gap(cube(4.0), cube(1.0, at=(1.0, 1.5, 1.5))) == (1.0, pytest.approx((0.5, 2.0, 2.0), abs=0.5))


def test_meeting_surfaces_have_no_gap():
    assert smallest_gap(cube(), cube(at=(0.5, 0.5, 0.5)))[0] == 0.0
    assert smallest_gap(cube(), cube(at=(1, 0, 0)))[0] == 0.0
    assert smallest_gap(cube(), cube(at=(1, 1, 1))) == (0.0, (1.0, 1.0, 1.0))
    # a thin spike through the middle of a face: no corner and no pair of sides comes near
    spike = soup([[[50.0, 50.0, -50.0], [50.0, 50.0, 50.0], [50.1, 50.0, 50.0]]])
    plate = soup([[[0, 0, 0], [200, 0, 0], [0, 200, 0]]])
    assert smallest_gap(plate, spike)[0] == smallest_gap(spike, plate)[0] == 0.0


def test_gap_names_the_faces():
    a, b = sphere(10.0, 3), together(sphere(1.0, 1, at=(0, 0, 30)), sphere(1.0, 1, at=(0, 0, 13)))
    gap = smallest_gap_between(FaceTree.of(a.vertices, a.faces), FaceTree.of(b.vertices, b.faces))
    assert gap.distance_mm == pytest.approx(2.0)
    assert gap.point_mm == pytest.approx((0, 0, 11))
    assert np.linalg.norm(a.triangles()[gap.face_a] - [0, 0, 10], axis=1).min() == 0.0
    assert np.linalg.norm(b.triangles()[gap.face_b] - [0, 0, 12], axis=1).min() < 1e-12


def test_concentric_spheres_of_many_faces():
    outer, inner = sphere(200.0, 5), sphere(199.0, 5)
    gap, _point = smallest_gap(outer, inner)
    assert 0.99 < gap < 1.0
    found = closest_points(outer.vertices, outer.faces, inner.vertices)[0]
    assert gap <= found.min() <= found.max() <= 1.0 + 1e-9


def test_one_face_is_a_tree_too():
    one = soup([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    assert closest_points(one.vertices, one.faces, np.array([[0.2, 0.2, 3.0]]))[0].tolist() == [3.0]


def test_the_tree_holds_every_face_once_within_its_boxes():
    mesh = together(sphere(5.0, 3), tetrahedron(0.1, at=(9, 9, 9)), cube(at=(-20, 0, 0)))
    tree = FaceTree.of(mesh.vertices, mesh.faces)
    assert sorted(tree.face) == list(range(len(mesh.faces)))
    assert (tree.corners == mesh.triangles()[tree.face]).all()
    for leaf in range(tree.leaves):
        held = tree.corners[leaf * len(tree.face) // tree.leaves : (leaf + 1) * len(tree.face) // tree.leaves]
        assert 1 <= len(held) <= face_tree.FACES_PER_LEAF
        node = tree.leaves - 1 + leaf
        assert (tree.boxes[node] == np.concatenate((held.min(axis=(0, 1)), held.max(axis=(0, 1))))).all()
        while node > 0:
            parent = (node - 1) // 2
            assert (tree.boxes[parent, :3] <= tree.boxes[node, :3]).all()
            assert (tree.boxes[parent, 3:] >= tree.boxes[node, 3:]).all()
            node = parent


def test_equal_centres_do_not_upset_the_tree():
    tree = FaceTree.of(cube().vertices, np.repeat(cube().faces[:1], 100, axis=0))
    assert sorted(tree.face) == list(range(100))


KERNELS = [
    triangle_distance.closest_on_triangle,
    triangle_distance.between_sides,
    triangle_distance.sides_of_plane,
    triangle_distance.pierce,
    triangle_distance.nearer,
    face_tree._sort_by_median_cuts,
    disc_bounds._set_axis,
    disc_bounds._enclose,
    disc_bounds._settle,
    disc_bounds._fill_leaves,
    disc_bounds._fill_parents,
    disc_bounds.between_discs,
    distance._to_box,
    distance._find_closest,
    distance._between_nodes,
    distance._size,
    distance._find_gap,
]


@pytest.mark.parametrize(
    "meshes", [(cube(), tetrahedron(at=(2, 3, 4))), (cube(), cube(at=(0.5, 0.5, 0.5)))], ids=["apart", "met"]
)
def test_plain_python_gives_the_same_bits(meshes, monkeypatch):
    def measure():
        trees = [FaceTree.of(mesh.vertices, mesh.faces) for mesh in meshes]
        return smallest_gap_between(*trees), [part.tolist() for part in closest_points_in(trees[0], meshes[1].vertices)]

    compiled = measure()
    for kernel in KERNELS:
        for module in (triangle_distance, face_tree, disc_bounds, distance):
            if hasattr(module, kernel.__name__):
                monkeypatch.setattr(module, kernel.__name__, kernel.py_func)
    assert measure() == compiled


def test_no_kernel_reads_beyond_its_arrays(tmp_path):
    script = (
        "from tests.solids import cube, sphere\n"
        "from core.geometry.distance import closest_points, smallest_gap\n"
        "assert smallest_gap(sphere(3.0), cube())[0] > 0 == smallest_gap(sphere(1.0), cube())[0]\n"
        "closest_points(sphere().vertices, sphere().faces, cube().vertices)\n"
    )
    checked = {**os.environ, "NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": os.pathsep.join(sys.path)}
    subprocess.run([sys.executable, "-c", script], check=True, env=checked, timeout=120)
