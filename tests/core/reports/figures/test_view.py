"""The z-buffer against shapes whose picture is known, and against itself without the compiler."""

import numpy as np
import pytest

from core.mesh import Mesh
from core.reports.figures import view as view_module
from core.reports.figures.view import NOTHING, SAMPLES, Scratch, Surface, View, look
from subjects.body import body
from tests.solids import cube, flipped, sphere, together, without_faces


def straight_down(half: float, pixels: int) -> View:
    return View.of([1, 0, 0], [0, 1, 0], [-half, -half], [half, half], pixels)


def test_a_sphere_covers_a_disc_and_is_nearest_in_its_middle():
    raster = look(Surface.of(sphere(10.0, 5)), straight_down(12.5, 200))
    per_mm = 200 * SAMPLES / 25.0
    assert raster.covered().sum() / per_mm**2 == pytest.approx(np.pi * 100, rel=5e-3)
    assert raster.nearest_mm == pytest.approx(10.0, abs=0.01)
    assert raster.depth.max() == pytest.approx(0.0, abs=0.01)
    assert np.unravel_index(raster.depth.argmax(), raster.depth.shape) == pytest.approx((200, 200), abs=3)


def test_depth_is_exact_on_a_plane():
    slope = Mesh.of([[-9, -9, -9], [9, -9, 9], [9, 9, 9], [-9, 9, -9]], [[0, 1, 2], [0, 2, 3]])
    raster = look(Surface.of(slope), straight_down(5.0, 50))
    columns = (np.arange(raster.depth.shape[1]) + 0.5) / (50 * SAMPLES / 10.0) - 5.0
    np.testing.assert_allclose(raster.depth + raster.nearest_mm, np.broadcast_to(columns, raster.depth.shape), atol=1e-5)


def test_the_nearer_shape_hides_the_other_and_its_places():
    near, far = cube(2.0, at=(-1, -1, 5)), cube(4.0, at=(-2, -2, -4))
    raster = look(Surface.of(together(far, near)), straight_down(3.0, 60))
    centre = raster.face[60, 60]
    assert centre >= len(far.faces)
    places = np.array([[0.0, 0.0, 0.0], [1.5, 1.5, 0.0], [0.0, 0.0, 7.0], [99.0, 0.0, 0.0]])
    assert raster.sees(places, slack_mm=0.1).tolist() == [False, True, True, False]
    assert raster.sees(places[:1], slack_mm=8.0).tolist() == [True]


def test_paint_shows_the_colours_of_the_faces_on_white():
    mesh = sphere(10.0, 4)
    colours = np.where((mesh.triangles().mean(axis=1)[:, 0] < 0)[:, None], [200, 0, 0], [0, 0, 200]).astype(np.uint8)
    picture = look(Surface.of(mesh), straight_down(12.5, 100)).paint(colours)
    assert picture.shape == (100, 100, 4)
    assert picture[0, 0].tolist() == [255, 255, 255, 255]
    assert (picture[:, :, 3] == 255).all()
    left, right = picture[50, 30], picture[50, 70]
    assert left[0] > 80
    assert left[2] <= 1
    assert right[2] > 80
    assert right[0] <= 1


def test_compiled_and_plain_kernels_agree():
    mesh = sphere(10.0, 2)
    raster = look(Surface.of(mesh), straight_down(12.5, 20))
    face, depth = np.zeros_like(raster.face), np.full_like(raster.depth, NOTHING)
    view_module._draw_faces.py_func(raster.projected, mesh.faces, 1, face, depth)
    np.testing.assert_array_equal(depth, raster.depth)
    np.testing.assert_array_equal(face[raster.covered()], raster.face[raster.covered()])
    colours = np.arange(len(mesh.faces) * 3, dtype=np.uint8).reshape(-1, 3)
    brightness, picture = np.linspace(0.4, 1.0, len(mesh.vertices)), np.empty((20, 20, 4), dtype=np.uint8)
    compiled = picture.copy()
    light = view_module._light_of_faces.py_func(raster.projected, mesh.faces, brightness)
    np.testing.assert_array_equal(light, view_module._light_of_faces(raster.projected, mesh.faces, brightness))
    arguments = (light, face, depth, 8.0, colours)
    view_module._paint.py_func(*arguments, picture)
    view_module._paint(*arguments, compiled)
    np.testing.assert_array_equal(picture, compiled)


def test_what_was_seen_before_in_the_same_room_does_not_show_through():
    scratch, down = Scratch(), straight_down(3.0, 60)
    far = Surface.of(cube(2.0, at=(-1, -1, -4)))
    alone = look(far, down).paint(np.full((12, 3), 200, dtype=np.uint8))
    look(Surface.of(cube(4.0, at=(-2, -2, 5))), down, scratch)
    again = look(far, down, scratch)
    assert again.sees(np.array([[1.5, 1.5, -5.0], [0.0, 0.0, -5.0]]), slack_mm=0.1).tolist() == [True, False]
    np.testing.assert_array_equal(again.paint(np.full((12, 3), 200, dtype=np.uint8)), alone)


def test_a_step_in_depth_gets_a_line_on_its_near_side():
    mesh = together(cube(80.0, at=(-40, -40, -80)), cube(20.0, at=(-10, -10, 20)))
    picture = look(Surface.of(mesh), straight_down(30.0, 120)).paint(np.full((len(mesh.faces), 3), 200, dtype=np.uint8))
    row = picture[60, :, 0].astype(int)
    assert row[39] > 150  # the far cube right beside the step
    assert row[40] < 0.8 * row[44]  # the line, on the near one
    assert abs(row[43] - row[45]) < 5  # and nothing inside of it


def test_faces_seen_from_behind_show_where_nothing_hides_them():
    closed, low = sphere(10.0, 3), straight_down(12.5, 60)
    inside_out = look(Surface.of(flipped(closed)), low)
    np.testing.assert_array_equal(inside_out.covered(), look(Surface.of(closed), low).covered())
    np.testing.assert_allclose(inside_out.depth, look(Surface.of(closed), low).depth, atol=1e-5)
    top_off = without_faces(closed, np.flatnonzero(closed.triangles().mean(axis=1)[:, 2] > 5.0))
    raster = look(Surface.of(top_off), low)
    assert raster.covered()[60, 60]
    assert raster.depth[60, 60] + raster.nearest_mm == pytest.approx(-10.0, abs=0.1)


def test_wide_faces_cover_what_their_halves_cover():
    corners = np.array([[-9.3, -7.1, 0], [8.7, -9.9, 0], [9.9, 8.2, 0], [-8.1, 9.6, 0], [0.4, -0.3, 0]])
    fan = Mesh.of(corners, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    wide = look(Surface.of(fan), straight_down(10.0, 150)).covered()
    middles = [(corners[a] + corners[b]) / 2 for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
    points, faces = [*corners, *middles], []
    for number, (a, b) in enumerate(((0, 1), (1, 2), (2, 3), (3, 0))):
        faces += [[a, 5 + number, 4], [5 + number, b, 4]]
    halved = look(Surface.of(Mesh.of(points, faces)), straight_down(10.0, 150)).covered()
    assert wide.sum() > 30_000
    assert (wide != halved).sum() <= 4  # samples on an edge, but for rounding


def test_a_body_is_drawn_whole_and_a_soup_of_huge_faces_is_thinned():
    skin = body(0)
    low, high = skin.vertices.min(axis=0)[:2], skin.vertices.max(axis=0)[:2]
    whole = View.of([1, 0, 0], [0, 1, 0], low, high, 1000)

    def stride(mesh):
        raster = look(Surface.of(mesh), whole)
        return view_module._stride(raster.projected, mesh.faces, raster.face.shape)

    assert stride(skin) == 1
    random = np.random.default_rng(5)
    assert stride(Mesh.of(random.normal(size=(300, 3)) * 400, random.integers(0, 300, (4000, 3)))) > 5
