"""The whole set of figures: complete, repeatable, and unafraid of broken meshes."""

import io
from dataclasses import dataclass

import numpy as np
import pytest
from PIL import Image

from core.geometry.body_frame import find_body_frame
from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.reports.figures import draw_mesh_figures, draw_shell_figures
from core.reports.figures.thickness_map import draw_thickness_map
from core.schema.finding import Finding, Place, Severity
from core.schema.report import PairReport
from subjects.body import body
from tests.solids import cube, sphere, tetrahedron, together


@dataclass(frozen=True)
class Drawn:
    name: str
    mesh: Mesh
    depth_mm: float | None


GAP = PairReport(
    a="skin",
    b="fat",
    relation="b_inside_a",
    intersecting_pairs=0,
    case_1=0,
    case_2=0,
    case_3=0,
    min_gap_mm=0.4,
    min_gap_point_mm=(29.8, 0.0, 0.0),
)
FINDING = Finding(
    code="shells.depth_limited",
    severity=Severity.WARNING,
    message="thin",
    count=3,
    places=(Place(mesh="fat", point_mm=(0.0, 0.0, 29.0)), Place(mesh="fat", point_mm=(0.0, 0.0, 0.0))),
)
SPHERES = (
    Drawn("skin", sphere(30.0, 4), None),
    Drawn("fat", sphere(29.0, 4), 1.0),
    Drawn("average_body", sphere(27.0, 4), 3.0),
)
DEPTHS = {"fat": np.full(len(SPHERES[1].mesh.faces), 1.0), "average_body": np.full(len(SPHERES[2].mesh.vertices), 2.9)}


def picture(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))


def test_shells_get_every_kind_of_figure_and_the_same_bytes_twice():
    figures = draw_shell_figures(SPHERES, DEPTHS, pairs=[GAP], findings=[FINDING])
    assert [figure.name for figure in figures] == [
        "sections",
        "thickness_fat",
        "thickness_average_body",
        "thickness_histogram",
        "surface",
        "gap_places",
        "quality_histogram",
    ]
    assert draw_shell_figures(SPHERES, DEPTHS, pairs=[GAP], findings=[FINDING]) == figures
    for figure in figures:
        assert 60 < len(figure.caption) < 600
        assert picture(figure.png).std() > 5  # not blank


def test_the_real_body_is_cut_through_head_and_torso():
    skin = body(0)
    inner = skin.with_vertices(skin.vertices - vertex_normals(skin.vertices, skin.faces)).rounded_to_float32()
    tissues = (Drawn("skin", skin, None), Drawn("fat", inner, 1.0))
    figures = {figure.name: figure for figure in draw_shell_figures(tissues, {"fat": np.full(len(inner.vertices), 1.0)})}
    assert list(figures) == ["sections_head", "sections_body", "thickness_fat", "thickness_histogram", "quality_histogram"]
    assert "Head at the ears" in figures["sections_head"].caption
    assert "Torso" in figures["sections_body"].caption
    assert sum(len(figure.png) for figure in figures.values()) < 2_500_000


def test_layers_without_depths_are_drawn_without_thickness():
    names = [figure.name for figure in draw_shell_figures(SPHERES, {})]
    assert names == ["sections", "quality_histogram"]


def test_thin_places_are_dark_on_the_thickness_map():
    mesh = sphere(30.0, 4)
    frame = find_body_frame(mesh)
    thin_half = np.where(mesh.vertices @ frame.right < 0, 0.3, 3.0)
    image = picture(draw_thickness_map("layer", mesh, thin_half, 3.0, frame).png).astype(int)
    first_view = image[: image.shape[0] // 2, : image.shape[1] // 2].sum(axis=2)
    painted = np.flatnonzero((first_view < 700).any(axis=0))
    middle = (painted[0] + painted[-1]) // 2
    row = first_view[first_view.shape[0] // 2]
    assert row[painted[0] + 20 : middle - 20].mean() < 0.5 * row[middle + 20 : painted[-1] - 20].mean()


def test_findings_are_circled_in_their_colour():
    plain = {figure.name: figure for figure in draw_mesh_figures({"skin": SPHERES[0].mesh})}
    marked = {figure.name: figure for figure in draw_mesh_figures({"skin": SPHERES[0].mesh}, findings=[FINDING])}
    assert "Circles" in marked["surface"].caption
    colour = np.array([0xB8, 0x6E, 0x00])

    def orange(png):
        return int((np.abs(picture(png).astype(int) - colour).max(axis=2) < 12).sum())

    assert orange(plain["surface"].png) == 0
    assert orange(marked["surface"].png) > 200


def soup(count: int, size: float) -> Mesh:
    random = np.random.default_rng(7)
    return Mesh.of(random.normal(size=(count, 3)) * size, random.integers(0, count, (2 * count, 3)))


@pytest.mark.parametrize(
    "meshes",
    [
        {"triangle": Mesh.of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])},
        {"point": Mesh.of([[1, 1, 1]] * 3, [[0, 1, 2]])},
        {"line": Mesh.of([[0, 0, 0], [5, 0, 0], [9, 0, 0]], [[0, 1, 2]])},
        {"huge": cube(1e7, at=(-5e6, -5e6, -5e6))},
        {"tiny": tetrahedron(1e-12)},
        {"far": together(tetrahedron(), tetrahedron(at=(1e6, 0, 0))), "$x^{": cube(3.0)},
        {"soup": soup(300, 100.0), "other": soup(300, 10.0)},
    ],
    ids=lambda meshes: next(iter(meshes)),
)
def test_broken_meshes_get_a_report_too(meshes):
    nowhere = Finding(
        code="mesh.odd",
        severity=Severity.ERROR,
        message="odd",
        count=2,
        places=(Place(mesh="x", point_mm=(0, 0, 0)), Place(mesh="x", point_mm=(1e9, 0, 0))),
    )
    names = [figure.name for figure in draw_mesh_figures(meshes, findings=[nowhere])]
    assert names[0] == "surface"
    assert names[-1] == "quality_histogram"
    assert len(set(names)) == len(names)
