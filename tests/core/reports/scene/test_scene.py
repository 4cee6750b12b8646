"""Scenes: read back by a reader of our own, every face is there, where it was, and the right way round."""

import base64
import re
import zlib

import numpy as np
import pytest

from core.mesh import Mesh
from core.reports.scene import face_order
from core.reports.scene.scene import DEPTH_STEPS, FORMAT_VERSION, Scene, make_scene
from subjects.body import body
from tests.project.sources import ROOT
from tests.solids import cube, sphere, together, without_faces


def unpacked(scene: Scene) -> dict[str, Mesh]:
    """As web/src/mesh/scene.ts does it, written for readers."""
    data, start, meshes = np.frombuffer(zlib.decompress(scene.data), dtype=np.uint8), 0, {}
    for surface in scene.about["surfaces"]:
        tables = []
        for rows in (surface["faces"], surface["vertices"]):
            runs = data[start : start + 9 * rows].reshape(3, 3, rows).astype(np.int64)
            tables.append((runs[:, 0] + (runs[:, 1] << 8) + (runs[:, 2] << 16)).T)
            start += 9 * rows
        steps, zigzag = tables
        off = np.where(zigzag % 2 == 1, -(zigzag + 1) // 2, zigzag // 2)
        faces, grid, following = np.zeros_like(steps), np.zeros_like(off), 0
        for f, row in enumerate(steps):
            news = []
            for k, step in enumerate(row):
                faces[f, k] = following - step
                if step == 0:
                    news.append(following)
                    following += 1
            for vertex in news:
                known = [corner for corner in faces[f] if corner < vertex]
                middle = grid[known].sum(axis=0) // len(known) if known else grid[vertex - 1] if vertex else 0
                grid[vertex] = off[vertex] + middle
        if surface["deepest_mm"] is not None:
            start += surface["vertices"]
        meshes[surface["name"]] = Mesh.of(np.array(scene.about["origin_mm"]) + scene.about["step_mm"] * grid, faces)
    assert start == len(data)
    return meshes


def corner_table(mesh: Mesh) -> np.ndarray:
    """Triangles (F, 9) turned so that the smallest corner comes first, in order: the same for the same surface."""
    triangles = mesh.triangles()
    first = np.array([min(range(3), key=lambda k: tuple(triangle[k])) for triangle in triangles])
    turned = np.array([np.roll(triangle, -k, axis=0).ravel() for triangle, k in zip(triangles, first, strict=True)])
    return turned[np.lexsort(turned.T[::-1])]


@pytest.mark.parametrize(
    "mesh",
    [
        cube(10.0),
        sphere(30.0, 3),
        together(sphere(5.0, 2), cube(3.0, at=(20, 0, 0))),
        without_faces(sphere(5.0, 2), [0, 7, 9]),
        Mesh.of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], [[0, 1, 2], [0, 1, 3], [1, 0, 4], [2, 2, 4]]),
        Mesh.of([[9, 9, 9], [0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 2, 3]]),
    ],
    ids=["cube", "sphere", "pieces", "open", "not manifold", "unused vertex"],
)
def test_every_face_comes_back_within_the_error_stated(mesh):
    scene = make_scene({"one": mesh})
    assert scene is not None
    back = unpacked(scene)["one"]
    # to the grid, so that both are sorted alike
    low, step = np.array(scene.about["origin_mm"]), scene.about["step_mm"]
    asked = Mesh.of(low + step * np.rint((mesh.vertices - low) / step), mesh.faces)
    np.testing.assert_allclose(corner_table(back), corner_table(asked), atol=1e-9)
    assert np.linalg.norm(asked.vertices - mesh.vertices, axis=1).max() <= scene.error_mm
    assert scene.about["version"] == FORMAT_VERSION


def test_depths_follow_the_vertices_and_those_of_faces_are_spread():
    ball = sphere(10.0, 3)
    heights = ball.vertices[:, 2] - ball.vertices[:, 2].min()
    for depths in (heights, heights[ball.faces].mean(axis=1)):
        scene = make_scene({"ball": ball}, {"ball": depths})
        assert scene is not None
        deepest = scene.about["surfaces"][0]["deepest_mm"]
        back = unpacked(scene)["ball"]
        steps = np.frombuffer(zlib.decompress(scene.data)[-len(ball.vertices) :], dtype=np.uint8)
        assert steps.min() >= 1
        found = (steps - 1.0) / DEPTH_STEPS * deepest
        expected = back.vertices[:, 2] - ball.vertices[:, 2].min()
        assert np.abs(found - expected).max() < (0.05 if depths is heights else 1.5)


def test_a_vertex_without_a_depth_is_told_from_one_at_zero():
    ball = sphere(10.0, 3)
    heights = ball.vertices[:, 2] + 10.0
    heights[ball.vertices[:, 2] < 0.0] = np.nan
    scene = make_scene({"ball": ball}, {"ball": heights})
    assert scene is not None
    steps = np.frombuffer(zlib.decompress(scene.data)[-len(ball.vertices) :], dtype=np.uint8)
    back = unpacked(scene)["ball"]
    np.testing.assert_array_equal(steps == 0, back.vertices[:, 2] < -scene.error_mm)
    # of faces: a vertex has none if no face around it has, else the mean of those that have
    of_faces = np.where(ball.triangles()[:, :, 2].max(axis=1) < 0.0, np.nan, 7.0)
    scene = make_scene({"ball": ball}, {"ball": of_faces})
    assert scene is not None
    steps = np.frombuffer(zlib.decompress(scene.data)[-len(ball.vertices) :], dtype=np.uint8)
    assert set(np.unique(steps)) == {0, 255}
    assert scene.about["surfaces"][0]["deepest_mm"] == 7.0


def test_a_surface_without_any_value_is_packed_as_such():
    ball = sphere(10.0, 2)
    scene = make_scene({"ball": ball}, {"ball": np.full(len(ball.faces), np.nan)})
    assert scene is not None
    assert set(zlib.decompress(scene.data)[-len(ball.vertices) :]) == {0}


def test_a_thinned_surface_has_no_depths():
    fine = sphere(30.0, 5)
    scene = make_scene({"fine": fine}, {"fine": np.ones(len(fine.vertices))}, most_faces=500)
    assert scene is not None
    assert scene.about["surfaces"][0]["deepest_mm"] is None
    assert unpacked(scene)["fine"].faces.max() > 0


def test_a_body_is_small_and_exact_to_a_hundredth_of_a_millimetre():
    skin = body(0)
    scene = make_scene({"skin": skin})
    assert scene is not None
    assert len(scene.data) < 3.0 * len(skin.faces)
    assert scene.error_mm < 0.01
    assert scene.about["surfaces"][0]["closed"]
    assert scene.thinned == ()


def test_the_largest_comes_first_whatever_the_order():
    scene = make_scene({"inner": sphere(10.0, 2), "outer": sphere(20.0, 2)})
    assert scene is not None
    assert [surface["name"] for surface in scene.about["surfaces"]] == ["outer", "inner"]
    assert make_scene({}) is None


def test_too_many_faces_are_thinned_and_said_so():
    fine = sphere(30.0, 5)
    scene = make_scene({"fine": fine, "finer": fine}, most_faces=len(fine.faces))
    assert scene is not None
    assert scene.thinned == ("fine", "finer")
    for surface in scene.about["surfaces"]:
        assert 0.1 * len(fine.faces) < surface["faces"] <= 0.5 * len(fine.faces)
        assert surface["of_faces"] == len(fine.faces)
    for mesh in unpacked(scene).values():
        radii = np.linalg.norm(mesh.vertices, axis=1)
        assert radii.min() > 27.0


def test_a_speck_is_thinned_to_something():
    scene = make_scene({"large": sphere(30.0, 5), "speck": cube(0.01)}, most_faces=200)
    assert scene is not None
    assert all(surface["faces"] > 0 for surface in scene.about["surfaces"])


def test_an_open_surface_is_not_called_closed():
    scene = make_scene({"open": without_faces(sphere(5.0, 2), [3])})
    assert scene is not None
    assert not scene.about["surfaces"][0]["closed"]


def test_the_page_reads_what_is_packed_here():
    """web/tests/scene.test.ts reads this very scene; if it fails, give the new format another version, there too."""
    tetrahedron = Mesh.of([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    scene = make_scene({"skin": tetrahedron}, {"skin": np.array([0.0, np.nan, 2.0, 0.5])})
    assert scene is not None
    source = (ROOT / "web" / "tests" / "scene.test.ts").read_text()
    packed = re.search(r'DATA =\s*"([^"]*)"', source)
    assert packed is not None
    assert zlib.decompress(base64.b64decode(packed[1])) == zlib.decompress(scene.data)


def test_same_surfaces_same_bytes_compiled_or_not():
    mesh = sphere(7.0, 3)
    first, second = make_scene({"a": mesh}), make_scene({"a": mesh})
    assert first == second
    faces, order = face_order.neighbours_first(mesh.faces, len(mesh.vertices))
    twins = face_order._twins.py_func(mesh.faces, len(mesh.vertices))
    plain, plain_order = face_order._renumbered.py_func(face_order._along_strips.py_func(mesh.faces, twins), len(mesh.vertices))
    np.testing.assert_array_equal(faces, plain)
    np.testing.assert_array_equal(order, plain_order)
    np.testing.assert_array_equal(face_order.steps_back(faces), face_order.steps_back.py_func(faces))
    grid = np.rint(mesh.vertices[order] * 100).astype(np.int64) + 1000
    np.testing.assert_array_equal(face_order.off_prediction(faces, grid), face_order.off_prediction.py_func(faces, grid))
