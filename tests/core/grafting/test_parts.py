"""The steps of a graft, each against numbers counted by hand."""

import numpy as np
import pytest

from core.geometry.adjacency import edges
from core.geometry.normals import face_areas, face_crosses
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
from core.grafting.band import _cheapest_path, triangulate_band
from core.grafting.bisect import bisect_at_wall
from core.grafting.pairing import pair_rims
from core.grafting.piece import Piece
from core.grafting.refine import refine_band
from core.grafting.rim import find_rims, tidy
from core.grafting.wall import wall_distance
from core.validation.validate import validate
from tests.solids import cube, sphere


def circle(count: int, radius: float = 1.0, z: float = 0.0, turn: float = 0.0) -> np.ndarray:
    angle = np.arange(count) * 2 * np.pi / count + turn
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle), np.full(count, z)))


def test_wall_distance_of_one_and_two_boxes() -> None:
    points = np.array([[0.5, 0.5, 0.5], [2, 0.5, 0.5], [2, 4, 0.5], [5, 5, 5]], dtype=float)
    unit = ((0, 0, 0), (1, 1, 1))
    assert wall_distance(points, [unit]).tolist() == [-0.5, 1, 3, 4]
    assert wall_distance(points, [unit, ((4, 4, 4), (6, 6, 6))]).tolist() == [-0.5, 1, 3, -1]


def test_a_band_between_equal_circles_takes_the_shortest_edges() -> None:
    band = triangulate_band(circle(12), circle(12, z=0.3, turn=2.0))
    points = np.concatenate((circle(12), circle(12, z=0.3, turn=2.0)))
    assert len(band) == 24
    found = edges(band)
    assert sorted(found.face_count.tolist()) == [1] * 24 + [2] * 24
    across = found.ends[found.face_count == 2]
    assert np.linalg.norm(points[across[:, 0]] - points[across[:, 1]], axis=1).max() < 0.8
    outward = np.einsum("ij,ij->i", face_crosses(points, band), points[band].mean(axis=1) * (1, 1, 0))
    assert (np.sign(outward) == np.sign(outward[0])).all()


@pytest.mark.parametrize(("outer", "inner"), [(3, 3), (3, 40), (57, 5)])
def test_a_band_uses_every_rim_edge_once(outer: int, inner: int) -> None:
    band = triangulate_band(circle(outer, 2.0), circle(inner, 1.0))
    found = edges(band)
    rim = {tuple(ends) for ends in found.ends[found.face_count == 1].tolist()}
    lines = ((0, outer), (outer, inner))
    assert rim == {tuple(sorted((first + i, first + (i + 1) % n))) for first, n in lines for i in range(n)}
    flat = np.concatenate((circle(outer, 2.0), circle(inner, 1.0)))
    ring = abs(polygon_area(outer, 2.0) - polygon_area(inner, 1.0))
    assert face_areas(flat, band).sum() >= ring - 1e-9


def polygon_area(count: int, radius: float) -> float:
    return count / 2 * radius**2 * np.sin(2 * np.pi / count)


def test_the_path_is_the_same_compiled_and_not() -> None:
    squared = np.random.default_rng(5).random((7, 11))
    plain, compiled = _cheapest_path.py_func(squared), _cheapest_path(squared)
    assert plain[0] == pytest.approx(compiled[0])
    assert np.array_equal(plain[1], compiled[1])
    assert (plain[1].sum(), len(plain[1])) == (7, 18)


def test_refining_keeps_the_rims_and_lifts_quality() -> None:
    points = np.concatenate((circle(60, 10.0), circle(60, 10.0, z=8.0, turn=0.3)))
    band = triangulate_band(points[:60], points[60:])
    no_edges = np.empty((0, 2), dtype=np.int64)
    finer, refined = refine_band(points, band, no_edges, lambda places: places)
    assert np.array_equal(finer[:120], points)
    assert quality(finer, refined).min() > 0.5 > quality(points, band).min()
    before, after = edges(band), edges(refined)
    assert np.array_equal(before.ends[before.face_count == 1], after.ends[after.face_count == 1])
    assert after.face_count.max() == 2


def test_no_edge_is_made_twice() -> None:
    # a dent in the outer rim: flipping its edge would make one that is there beside the band already
    outer = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [2, 3.9, 0], [0, 4, 0]], dtype=float)
    inner = np.array([[1, 1, 0], [3, 1, 0], [3, 3, 0], [1, 3, 0]], dtype=float)
    points = np.concatenate((outer, inner))
    band = triangulate_band(outer, inner)
    _, free = refine_band(points, band, np.empty((0, 2), dtype=np.int64), lambda places: places)
    assert (2, 4) not in {
        tuple(ends) for ends in edges(refine_band(points, band, np.array([[4, 2]]), lambda p: p)[1]).ends.tolist()
    }
    assert edges(free).face_count.max() == 2


def test_bisecting_keeps_the_surface_and_its_vertices() -> None:
    mesh = cube(100)
    box = ((-10.0, -10.0, 40.0), (60.0, 110.0, 110.0))
    fine = bisect_at_wall(mesh, [box], margin_mm=2.0, edge_mm=5.0)
    assert np.array_equal(fine.vertices[:8], mesh.vertices)
    assert validate({"fine": fine}).verdict == "simulation_ready"
    assert face_areas(fine.vertices, fine.faces).sum() == pytest.approx(60_000)
    assert signed_volumes(fine.vertices, fine.faces, np.zeros(len(fine.faces), dtype=np.int64))[0] == pytest.approx(1e6)
    near = np.abs(wall_distance(fine.vertices[fine.faces].mean(axis=1), [box])) < 2.0
    corners = fine.triangles()[near]
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= 5.0
    assert quality(fine.vertices, fine.faces).min() > 0.4
    assert len(fine.faces) < 5000  # only near the walls


def test_bisecting_leaves_a_fine_mesh_alone() -> None:
    mesh = sphere(10, 4)
    assert bisect_at_wall(mesh, [((0, 0, 0), (20, 20, 20))], margin_mm=1.0, edge_mm=9.0) is mesh


def test_tidy_rims_are_simple() -> None:
    mesh = sphere(50, 4)
    rough = np.random.default_rng(3).random(len(mesh.faces)) < 0.45
    rough |= mesh.triangles()[:, :, 2].mean(axis=1) > 10
    taken = tidy(mesh.faces, rough)
    chosen = mesh.faces[taken]
    rims = find_rims(chosen)
    corners = np.concatenate(rims)
    assert len(np.unique(corners)) == len(corners)
    assert len(corners) == (edges(chosen).face_count == 1).sum()


def test_rims_run_with_their_faces() -> None:
    mesh = cube(1)
    (rim,) = find_rims(np.delete(mesh.faces, [0, 1], axis=0))
    sides = {(int(a), int(b)) for face in mesh.faces[2:] for a, b in zip(face, np.roll(face, -1), strict=True)}
    assert all((int(a), int(b)) in sides for a, b in zip(rim, np.roll(rim, -1), strict=True))


def test_rims_pair_with_the_nearest_and_only_mutually() -> None:
    base = [circle(8, z=0.0), circle(8, z=10.0)]
    donor = [circle(5, z=9.0), circle(30, z=0.5)]
    assert pair_rims(base, donor) == [(0, 1), (1, 0)]
    assert pair_rims(base, donor[:1]) == [(1, 0)]
    assert pair_rims([], donor) == []


def test_a_rim_that_grazes_the_wall_is_filled_or_dropped() -> None:
    ball = sphere(50, 4)
    box = ((-100.0, -100.0, 48.5), (100.0, 100.0, 100.0))
    outside = Piece.cut("base", ball, [box], inside=False, margin_mm=0.1)
    (rim,) = outside.rims
    assert outside.with_turned(rim, 1.0) is None  # the cap is 1.5 mm high
    filled = outside.with_turned(rim, 2.0)
    assert filled is not None
    assert filled.taken.all()
    cap = Piece.cut("donor", ball, [box], inside=True, margin_mm=0.1)
    dropped = cap.with_turned(cap.rims[0], 2.0)
    assert dropped is not None
    assert not dropped.taken.any()
