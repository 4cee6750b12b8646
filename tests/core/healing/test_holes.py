"""Patches over holes: they go on as the surface does, are as fine as it is, and run through nothing."""

import numpy as np
import pytest

from core.geometry.adjacency import edges
from core.geometry.quality import quality
from core.healing.fairing import fair, spread
from core.healing.holes import fill_holes
from core.healing.loop_triangulation import LONGEST_AT_ONCE, triangulate_loop
from core.healing.patch_refinement import flip_to_delaunay, refine
from core.mesh import Mesh
from core.validation.surface import Surface
from tests.solids import cube, sphere, torus, without_faces

NO_EDGES = np.empty((0, 2), dtype=np.int64)


def polygon(count: int, radius: float = 1.0) -> np.ndarray:
    angle = np.arange(count) * 2 * np.pi / count
    return radius * np.column_stack((np.cos(angle), np.sin(angle), np.zeros(count)))


def area(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def without_cap(mesh: Mesh, height: float) -> Mesh:
    return without_faces(mesh, np.flatnonzero(mesh.triangles().mean(axis=1)[:, 2] > height))


@pytest.mark.parametrize("count", [4, 5, 12, LONGEST_AT_ONCE + 1, 1000])
def test_a_plane_rim_is_covered_once_and_in_its_direction(count: int) -> None:
    points = polygon(count)
    triangles = triangulate_loop(points, np.full((count, 3), np.nan), np.eye(count, dtype=bool))
    assert len(triangles) == count - 2
    assert area(points, triangles) == pytest.approx(count / 2 * np.sin(2 * np.pi / count))
    crosses = np.cross(points[triangles[:, 1]] - points[triangles[:, 0]], points[triangles[:, 2]] - points[triangles[:, 0]])
    assert (crosses[:, 2] > 0.0).all()
    found = edges(triangles.astype(np.int32))
    assert (found.face_count == 1).sum() == count
    assert found.face_count.max() == 2


def test_a_rim_that_is_not_convex_is_not_covered_outside() -> None:
    # an L, whose shortest chord leads through the outside
    points = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]], dtype=float)
    outer = np.array([[1, -1, 0], [4, 0.5, 0], [2, 2, 0], [2, 2, 0], [0.5, 4, 0], [-1, 1, 0]], dtype=float)
    triangles = triangulate_loop(points, outer, np.eye(6, dtype=bool))
    assert area(points, triangles) == pytest.approx(5.0)


def test_no_chord_doubles_an_edge_of_the_surface() -> None:
    points = polygon(4)
    forbidden = np.eye(4, dtype=bool)
    forbidden[0, 2] = forbidden[2, 0] = True
    triangles = triangulate_loop(points, np.full((4, 3), np.nan), forbidden)
    assert {tuple(sorted(triangle)) for triangle in triangles.tolist()} == {(0, 1, 3), (1, 2, 3)}


def test_flips_make_the_diagonal_delaunay_unless_it_is_taken() -> None:
    points = np.array([[0, 0, 0], [2, -0.5, 0], [4, 0, 0], [2, 0.5, 0]])
    long_way = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    flipped = flip_to_delaunay(points, long_way, NO_EDGES)
    assert {tuple(sorted(face)) for face in flipped.tolist()} == {(0, 1, 3), (1, 2, 3)}
    assert np.array_equal(flip_to_delaunay(points, long_way, np.array([[1, 3]])), long_way)


def test_refinement_reaches_the_size_asked_for() -> None:
    count = 40
    points = polygon(count, 10.0)
    triangles = triangulate_loop(points, np.full((count, 3), np.nan), np.eye(count, dtype=bool)).astype(np.int32)
    side = 2 * 10.0 * np.sin(np.pi / count)
    refined, faces, patch, size = refine(
        points, triangles, np.zeros(len(triangles), dtype=np.int64), np.full(count, side), NO_EDGES
    )
    assert np.array_equal(refined[:count], points)
    assert len(patch) == len(faces)
    assert size == pytest.approx(side)
    ideal = 10.0**2 * np.pi / (np.sqrt(3) / 4 * side**2)
    assert 0.5 * ideal < len(faces) < 2.5 * ideal
    assert quality(refined, faces).mean() > 0.75


def test_a_plate_in_a_plane_stays_in_it() -> None:
    height, width = 8, 8
    points = np.array([[x, y, 0.0] for x in range(width) for y in range(height)], dtype=float)
    index = np.arange(width * height).reshape(width, height)
    a, b, c, d = (index[i : i + width - 1, j : j + height - 1].ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    faces = np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d)))).astype(np.int32)
    free = np.zeros(len(points), dtype=bool)
    free[index[2:-2, 2:-2]] = True
    bumped = points + np.where(free[:, None], [0.0, 0.0, 1.0], 0.0)
    for flattened in (fair(bumped, faces, free, 1), fair(bumped, faces, free, 2), spread(bumped, faces, free)):
        assert np.abs(flattened[:, 2]).max() < 1e-9
        assert np.array_equal(flattened[~free], bumped[~free])


@pytest.mark.parametrize(("height", "share"), [(9.0, 0.05), (7.0, 0.12), (3.0, 0.35)])
def test_a_cap_of_a_ball_comes_back_round(height: float, share: float) -> None:
    ball = sphere(10.0, 4).rounded_to_float32()
    open_ball = without_cap(ball, height)
    vertices, faces, changes = fill_holes(open_ball.vertices, open_ball.faces)
    assert Surface("ball", Mesh.of(vertices, faces)).closed
    assert np.array_equal(faces[: len(open_ball.faces)], open_ball.faces)
    assert np.array_equal(vertices[: len(open_ball.vertices)], open_ball.vertices)
    new = vertices[np.unique(faces[len(open_ball.faces) :])]
    missing = 10.0 - height
    assert np.abs(np.linalg.norm(new, axis=1) - 10.0).max() < share * missing
    assert quality(vertices, faces[len(open_ball.faces) :]).min() > 0.2
    assert changes[0].distances[0] < np.sqrt(100 - height**2) + missing


def test_a_missing_vertex_comes_back() -> None:
    ball = sphere(10.0, 3).rounded_to_float32()
    star = np.flatnonzero((ball.faces == 100).any(axis=1))
    vertices, faces, _ = fill_holes(ball.vertices, np.delete(ball.faces, star, axis=0))
    assert len(faces) - len(ball.faces) in (0, 2)
    assert np.abs(np.linalg.norm(vertices[len(ball.vertices) :], axis=1) - 10.0).max() < 0.1


def test_a_missing_ring_joins_the_two_ends_of_the_tube() -> None:
    tube = torus(10.0, 3.0, 40, 16).rounded_to_float32()
    two = without_faces(tube, np.concatenate((np.arange(32), 20 * 32 + np.arange(32))))
    vertices, faces, changes = fill_holes(two.vertices, two.faces)
    surface = Surface("torus", Mesh.of(vertices, faces))
    assert surface.closed
    assert surface.component_count == 1
    assert len(np.unique(faces)) - len(surface.edges.ends) + len(faces) == 0  # a torus again
    assert len(surface.intersecting) == 0
    assert changes[-1].kind == "holes"


def test_a_patch_that_would_run_through_the_surface_is_flattened() -> None:
    # a needle stands where the patch would bulge
    ball = without_cap(sphere(10.0, 3), 7.0)
    needle = sphere(1.0, 1)
    needle = needle.with_vertices(needle.vertices * [0.2, 0.2, 1.0] + [0.3, 0.2, 9.0])
    vertices = np.concatenate((ball.vertices, needle.vertices)).astype(np.float32).astype(np.float64)
    faces = np.concatenate((ball.faces, needle.faces + np.int32(len(ball.vertices))))
    vertices, faces, _ = fill_holes(vertices, faces)
    surface = Surface("ball", Mesh.of(vertices, faces))
    assert surface.closed
    assert len(surface.intersecting) == 0


def test_holes_that_share_an_edge_of_rims_make_no_edge_twice() -> None:
    # all four side walls of a cube taken out in turn leave rims over the same vertices
    mesh = cube(10.0)
    for gone in ([0, 2], [0, 1, 2, 3], [0, 3, 6]):
        left = without_faces(mesh, gone)
        faces = fill_holes(left.vertices, left.faces)[1]
        assert edges(faces).face_count.max() == 2
