"""A report can be mailed: 8 MB at 107,000 faces a surface."""

from dataclasses import dataclass

import numpy as np
import pytest

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.reports.figures import Figure, draw_shell_figures
from core.reports.figures.field_map import draw_field_map
from core.reports.html import render_html
from core.reports.scene.mailable import (
    BYTES_PER_FACE,
    LEAST_FACES,
    MOST_BYTES,
    PAGE_BYTES,
    mailable_faces,
)
from core.reports.scene.scene import MOST_FACES, Painted, Scene, make_scene
from core.reports.scene.viewer import report_viewer
from core.schema.report import Report
from subjects.body import body

TABLES_BYTES = 100_000


@dataclass(frozen=True)
class Drawn:
    name: str
    mesh: Mesh
    depth_mm: float | None


def layered(skin: Mesh, depths_mm: tuple[float, ...]) -> list[Drawn]:
    """Not proven to be anything: what counts is how much there is to show."""
    normals = vertex_normals(skin.vertices, skin.faces)
    inner = [Drawn(f"layer_{depth}", skin.with_vertices(skin.vertices - depth * normals), depth) for depth in depths_mm]
    return [Drawn("skin", skin, None), *inner]


def measured(drawn: list[Drawn]) -> dict[str, np.ndarray]:
    noise = np.random.default_rng(1).random(len(drawn[0].mesh.vertices))
    return {each.name: each.depth_mm * (1 - 0.03 * noise) for each in drawn if each.depth_mm is not None}


def size(figures: tuple[Figure, ...], scene: Scene | None) -> int:
    report = Report(process="shells", verdict="simulation_ready", summary="made for its size")
    return len(render_html(report, figures, scene).encode())


def test_viewer_surfaces_and_figures_together_stay_below() -> None:
    viewer = len(report_viewer().script.encode()) + len(report_viewer().licences.encode())
    assert viewer + TABLES_BYTES < PAGE_BYTES
    drawn = layered(body(0), (1.0, 3.0))
    meshes = {each.name: each.mesh for each in drawn}
    faces = sum(len(mesh.faces) for mesh in meshes.values())
    whole, thinned = make_scene(meshes, measured(drawn)), make_scene(meshes, most_faces=faces // 3)
    assert whole is not None
    assert thinned is not None
    assert len(whole.data) < BYTES_PER_FACE * faces
    assert len(thinned.data) < BYTES_PER_FACE * (faces // 3)


def test_the_more_figures_the_fewer_faces() -> None:
    def drawn(bytes_each: int) -> list[Figure]:
        return [Figure(f"view_{number}", "", "", bytes(bytes_each)) for number in range(22)]

    faces = [mailable_faces(drawn(size)) for size in (0, 100_000, 200_000, 400_000)]
    assert faces == [MOST_FACES, 946_969, 280_303, LEAST_FACES]


def test_a_report_with_many_figures_is_thinned_until_it_can_be_mailed() -> None:
    noise = np.random.default_rng(3)
    figures = tuple(Figure(f"view_{number}", "", "", noise.bytes(225_000)) for number in range(22))
    drawn = layered(body(1), (1.0, 3.0))
    scene = make_scene({each.name: each.mesh for each in drawn}, measured(drawn), mailable_faces(figures))
    assert scene is not None
    assert scene.thinned == ("skin", "layer_1.0", "layer_3.0")
    assert 0.8 * MOST_BYTES < size(figures, scene) < MOST_BYTES


@pytest.mark.slow
@pytest.mark.parametrize("others", [0, 3])
def test_six_layers_of_107_024_faces_can_be_mailed(others: int) -> None:
    drawn = layered(body(1), (0.3, 0.6, 1.0, 2.0, 3.0, 5.0))
    depths = measured(drawn)
    before = {f"{each.name} before": each.mesh for each in drawn[:others]}
    scene = make_scene({**{each.name: each.mesh for each in drawn}, **before}, depths)
    assert size(draw_shell_figures(drawn, depths), scene) < MOST_BYTES


@pytest.mark.slow
def test_a_field_on_three_surfaces_of_107_024_faces_can_be_mailed() -> None:
    drawn = layered(body(1), (1.0, 3.0))
    random = np.random.default_rng(2)
    fields = {each.name: random.random(len(each.mesh.faces)) * 100 for each in drawn}
    figures = tuple(draw_field_map(each.name, each.mesh, fields[each.name], None, drawn[0].mesh) for each in drawn)
    scene = make_scene({each.name: each.mesh for each in drawn}, fields, painted=Painted("field", "V/m"))
    assert size(figures, scene) < MOST_BYTES
