"""Each stage on the smallest surface that has its fault."""

import numpy as np
import pytest

from core.errors import InputError
from core.geometry.adjacency import edges
from core.healing.borders import find_loops
from core.healing.bridging import join_rims
from core.healing.coincident import drop_doubled_faces, drop_flat_faces, join_equal_vertices
from core.healing.cracks import WELD_SHARE, join_cracks
from core.healing.edge_pairing import pair_faces
from core.healing.fan_splitting import PULL
from core.healing.local_crossings import find_crossings_of
from core.healing.nonmanifold_edges import mend_nonmanifold_edges
from core.healing.orientation import agree
from core.healing.pieces import drop_scraps
from core.healing.pinched_vertices import part_pinched_vertices
from core.healing.t_junctions import SHARE, split_sides_at_vertices
from core.healing.winding import winding_number
from core.mesh import Mesh
from core.validation.surface import Surface
from tests.solids import cube, moebius_strip, octahedron, sphere, tetrahedron, without_faces

STAGES = (
    join_equal_vertices,
    drop_flat_faces,
    drop_doubled_faces,
    split_sides_at_vertices,
    join_cracks,
    mend_nonmanifold_edges,
    agree,
    part_pinched_vertices,
)


def soup(mesh: Mesh) -> Mesh:
    return Mesh.of(mesh.triangles().reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_leaves_a_fit_surface_alone(stage) -> None:
    mesh = sphere(5.0, 2)
    vertices, faces, changes = stage(mesh.vertices, mesh.faces)
    assert changes == []
    assert vertices is mesh.vertices
    assert faces is mesh.faces


def test_soup_is_joined_to_the_surface_it_was() -> None:
    mesh = soup(cube(2.0))
    _vertices, faces, changes = join_equal_vertices(mesh.vertices, mesh.faces)
    assert len(np.unique(faces)) == 8
    assert Surface("cube", Mesh.of(mesh.vertices, faces)).closed
    assert len(changes[0].points) == 8
    assert changes[0].distances.max() == 0.0


def test_a_cap_goes_and_its_long_side_is_split() -> None:
    # a cube with a vertex in the middle of an edge that only one of the two faces there knows, and a face without area between
    mesh = cube(2.0)
    a, b, c = mesh.faces[0]
    vertices = np.concatenate((mesh.vertices, (mesh.vertices[[a]] + mesh.vertices[[b]]) / 2))
    faces = np.concatenate((mesh.faces[1:], [[a, 8, c], [8, b, c], [a, b, 8]])).astype(np.int32)
    vertices, faces, flat = drop_flat_faces(vertices, faces)
    vertices, faces, split = split_sides_at_vertices(vertices, faces)
    assert [len(change.points) for change in (*flat, *split)] == [1, 1]
    surface = Surface("cube", Mesh.of(vertices, faces))
    assert surface.closed
    assert len(surface.degenerate) == 0
    assert surface.component_volumes == pytest.approx([8.0])


def test_a_needle_is_not_taken_for_a_cap() -> None:
    needle = np.array([[0, 0, 0], [1e-9, 0, 0], [100, 0, 0], [0, 1, 0]], dtype=float)
    _vertices, faces, changes = drop_flat_faces(needle + np.array([0, 1e-7, 0]), np.array([[0, 1, 3]], dtype=np.int32))
    assert (len(faces), changes) == (1, [])


@pytest.mark.parametrize(("gap", "joined"), [(0.1, True), (0.9 * WELD_SHARE, True), (1.1 * WELD_SHARE, False)])
def test_cracks_close_within_a_share_of_the_edges(gap: float, joined: bool) -> None:
    # two squares of side 1 with a gap between them
    left = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    vertices = np.concatenate((left, left + np.array([1 + gap, 0, 0])))
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], dtype=np.int32)
    _vertices, faces, changes = join_cracks(vertices, faces)
    assert len(np.unique(faces)) == (6 if joined else 8)
    assert [pytest.approx(change.distances) for change in changes] == ([[gap, gap]] if joined else [])


def test_an_asked_tolerance_counts() -> None:
    left = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    vertices = np.concatenate((left, left + np.array([1.05, 0, 0])))
    faces = np.array([[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], dtype=np.int32)
    assert join_cracks(vertices, faces, 0.04)[2] == []
    assert len(np.unique(join_cracks(vertices, faces, 0.06)[1])) == 6


def test_several_vertices_on_one_side_come_in_order() -> None:
    vertices = np.array([[0, 0, 0], [4, 0, 0], [2, 3, 0], [3, 0, 0], [1, 0, 0], [2, 0, 0], [2, -3, 0]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 6, 4], [4, 6, 5], [5, 6, 3], [3, 6, 1]], dtype=np.int32)
    _vertices, split, changes = split_sides_at_vertices(vertices, faces)
    assert len(split) == 8
    assert len(changes[0].points) == 3
    assert edges(split).face_count.max() == 2
    assert find_loops(split)[0].tolist() in (
        [list(np.roll([0, 2, 1, 6][::-1], shift)) for shift in range(4)]
        + [list(np.roll([0, 6, 1, 2][::-1], shift)) for shift in range(4)]
    )


def test_a_vertex_beside_a_side_does_not_split_it() -> None:
    off = 4 * 1.5 * SHARE
    vertices = np.array([[0, 0, 0], [4, 0, 0], [2, 3, 0], [2, -off, 0], [2, -3, 0]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 4, 3], [3, 4, 1]], dtype=np.int32)
    assert split_sides_at_vertices(vertices, faces)[2] == []


def test_fins_go_and_nothing_else() -> None:
    mesh = sphere(5.0, 2)
    a, b, _ = mesh.faces[7]
    vertices = np.concatenate((mesh.vertices, [2 * mesh.vertices[a]]))
    fin = np.array([[a, b, len(mesh.vertices)]], dtype=np.int32)
    _vertices, faces, changes = mend_nonmanifold_edges(vertices, np.concatenate((mesh.faces, fin)))
    assert np.array_equal(faces, mesh.faces)
    assert [(change.kind, len(change.taken)) for change in changes] == [("fins", 1)]


def test_an_inner_wall_goes() -> None:
    mesh = octahedron(5.0)
    wall = np.array([[0, 1, 3], [0, 3, 4]], dtype=np.int32)
    _vertices, faces, changes = mend_nonmanifold_edges(mesh.vertices, np.concatenate((mesh.faces, wall)))
    assert np.array_equal(faces, mesh.faces)
    assert [(change.kind, len(change.taken)) for change in changes] == [("inner_walls", 2)]


def test_bodies_with_a_common_edge_are_parted() -> None:
    first, second = cube(2.0), cube(2.0, (2.0, 2.0, 0.0))
    both = soup(Mesh.of(np.concatenate((first.vertices, second.vertices)), np.concatenate((first.faces, second.faces + 8))))
    vertices, faces, _ = join_equal_vertices(both.vertices, both.faces)
    assert edges(faces).face_count.max() == 4
    vertices, faces, changes = mend_nonmanifold_edges(vertices, faces)
    surface = Surface("cubes", Mesh.of(vertices, faces))
    assert surface.closed
    assert surface.manifold
    assert surface.component_count == 2
    assert len(surface.intersecting) == 0
    assert [change.kind for change in changes] == ["shared_edges"]
    assert surface.component_volumes.sum() == pytest.approx(16.0, rel=PULL)


def test_a_bow_tie_is_parted() -> None:
    lower, upper = tetrahedron(2.0), tetrahedron(-2.0)
    faces = np.concatenate((lower.faces, np.where(upper.faces == 0, 0, upper.faces + 3)[:, ::-1])).astype(np.int32)
    vertices = np.concatenate((lower.vertices, upper.vertices[1:]))
    vertices, faces, changes = part_pinched_vertices(vertices, faces)
    surface = Surface("tie", Mesh.of(vertices, faces))
    assert surface.manifold
    assert surface.component_count == 2
    assert len(surface.intersecting) == 0
    assert 0.0 < changes[0].distances[0] < 0.1


def test_pairs_of_faces_around_an_edge_bound_a_body() -> None:
    # two quarters of a circle with the bodies from 0° to 90° and from 180° to 270°
    angle = np.radians([0.0, 90.0, 180.0, 270.0])
    assert sorted(pair_faces(angle, np.array([False, True, False, True]))) == [(0, 1), (2, 3)]
    # the other way round the bodies lie between
    assert sorted(pair_faces(angle, np.array([True, False, True, False]))) == [(1, 2), (3, 0)]
    # five faces: one is left
    assert len(pair_faces(np.arange(5.0), np.array([True, False, True, False, True]))) == 2


def test_holes_that_meet_in_a_vertex_are_told_apart() -> None:
    mesh = sphere(5.0, 2)
    around = np.flatnonzero((mesh.faces == 0).any(axis=1))
    ends = [set(mesh.faces[face].tolist()) for face in around]
    opposite = next(face for face, corners in zip(around, ends, strict=True) if corners & ends[0] == {0})
    loops = find_loops(without_faces(mesh, [around[0], opposite]).faces)
    assert sorted(sorted(loop.tolist()) for loop in loops) == sorted(
        sorted(corners) for corners in (ends[0], set(mesh.faces[opposite].tolist()))
    )


def test_rims_of_an_islet_are_joined_and_of_strangers_are_not() -> None:
    mesh = sphere(5.0, 3)
    height = mesh.triangles().mean(axis=1)[:, 2]
    ring = without_faces(mesh, np.flatnonzero((height > 3.5) & (height < 4.5)))
    piece = (ring.triangles().mean(axis=1)[:, 2] > 4.0).astype(np.int64)
    gaps = join_rims(ring.vertices, ring.faces, find_loops(ring.faces), piece)
    assert len(gaps.rims) == 1
    assert len(gaps.turned) == 0
    upside_down = np.where(piece[:, None] == 1, ring.faces[:, ::-1], ring.faces)
    assert join_rims(ring.vertices, upside_down, find_loops(upside_down), piece).turned.tolist() in ([0], [1])
    far = ring.vertices + np.where(np.isin(np.arange(len(ring.vertices)), ring.faces[piece == 1])[:, None], [0, 0, 50.0], 0.0)
    assert len(join_rims(far, ring.faces, find_loops(ring.faces), piece).rims) == 2


def test_scraps_go_unless_they_enclose_something_and_are_wanted() -> None:
    ball, cup = sphere(5.0, 3), without_faces(sphere(1.0, 2, (20, 0, 0)), [0])
    scrap = np.array([[30, 0, 0], [31, 0, 0], [31, 1, 0], [30, 1, 0]], dtype=float)
    vertices = np.concatenate((ball.vertices, cup.vertices, scrap))
    shift = len(ball.vertices) + len(cup.vertices)
    flat = np.array([[0, 1, 2], [0, 2, 3]]) + shift
    faces = np.concatenate((ball.faces, cup.faces + len(ball.vertices), flat)).astype(np.int32)
    assert len(drop_scraps(vertices, faces, "keep_all")[1]) == len(ball.faces) + len(cup.faces)
    tiny = 0.2 * (vertices - np.array([20, 0, 0])) + np.array([20, 0, 0])
    vertices[len(ball.vertices) : shift] = tiny[len(ball.vertices) : shift]
    assert len(drop_scraps(vertices, faces, "keep_all")[1]) == len(ball.faces) + len(cup.faces)
    assert len(drop_scraps(vertices, faces, "keep_largest")[1]) == len(ball.faces)


def test_the_winding_number_is_one_inside_and_half_of_it_for_half_a_ball() -> None:
    ball = sphere(5.0, 3)
    middle = np.array([0.01, 0.02, 0.03])
    assert winding_number(ball.vertices, ball.faces, middle) == pytest.approx(1.0)
    assert winding_number(ball.vertices, ball.faces[:, ::-1], middle) == pytest.approx(-1.0)
    assert winding_number(ball.vertices, ball.faces, middle + 9.0) == pytest.approx(0.0, abs=1e-12)
    upper = ball.faces[ball.triangles().mean(axis=1)[:, 2] > 0.0]
    assert winding_number(ball.vertices, upper, np.zeros(3)) == pytest.approx(0.5)


def test_crossings_of_some_faces_are_those_of_all() -> None:
    first, second = sphere(5.0, 2), sphere(5.0, 2, (6.1, 0.3, 0.2))
    vertices = np.concatenate((first.vertices, second.vertices))
    faces = np.concatenate((first.faces, second.faces + np.int32(len(first.vertices))))
    everything = find_crossings_of(vertices, faces, np.arange(len(faces)))
    assert len(everything) > 20
    some = np.unique(everything)[:5]
    expected = everything[np.isin(everything, some).any(axis=1)]
    assert np.array_equal(find_crossings_of(vertices, faces, some), expected)


def test_a_third_sheet_joins_the_seam_of_two() -> None:
    # three half planes that meet in one line, give or take a hundredth
    spokes = [np.array([np.cos(angle), np.sin(angle), 0.0]) for angle in (0.0, 2.0, 4.0)]
    vertices, faces = [], []
    for number, spoke in enumerate(spokes):
        near, top = 0.01 * spoke, np.array([0.0, 0.0, 1.0])
        vertices += [near, near + top, spoke + top, spoke]
        faces += [[4 * number, 4 * number + 1, 4 * number + 2], [4 * number, 4 * number + 2, 4 * number + 3]]
    _vertices, joined, _changes = join_cracks(np.array(vertices), np.array(faces, dtype=np.int32))
    found = edges(joined)
    assert sorted(np.unique(found.face_count).tolist()) == [1, 2, 3]
    assert len(np.unique(joined)) == 8


def test_few_faces_go_to_make_a_long_strip_two_sided() -> None:
    strip = moebius_strip(200)
    vertices, faces, changes = agree(strip.vertices, strip.faces)
    assert changes[0].kind == "twists"
    assert 0 < len(strip.faces) - len(faces) <= 4
    assert Surface("strip", Mesh.of(vertices, faces)).consistent
    with pytest.raises(InputError) as refusal:
        agree(moebius_strip(8).vertices, moebius_strip(8).faces)
    assert refusal.value.code == "heal.one_sided"
