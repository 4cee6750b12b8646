"""Before and after: what a reader of a decimation or a smoothing sees."""

import io

import numpy as np
from PIL import Image

from core.geometry.body_frame import find_body_frame
from core.geometry.deviation import measure_deviation
from core.mesh import Mesh
from core.reports.figures.compare import draw_comparison
from core.reports.figures.curvature_pair import draw_curvature_pair, face_curvature
from core.reports.figures.deviation_map import draw_deviation_map
from core.schema.finding import Finding, Place, Severity
from core.schema.report import Report
from core.validation.validate import validate
from tests.solids import cube, sphere, without_faces


def picture(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def test_the_curvature_of_a_cube_is_counted_by_hand() -> None:
    """Every face of a cube cut along diagonals has one neighbour in its plane and two at a right angle."""
    assert np.allclose(face_curvature(cube(10.0)), 60.0)


def test_a_face_without_neighbours_has_no_curvature() -> None:
    assert face_curvature(Mesh.of(np.eye(3), [(0, 1, 2)])) == [0.0]


def test_both_halves_show_the_same_views() -> None:
    before, after = sphere(30.0, 4), sphere(30.0, 1)
    figure = draw_curvature_pair("skin", before, after, find_body_frame(before))
    image = picture(figure.png)
    middle = image.shape[1] // 2
    drawn = [
        (half < 700).any(axis=1).sum() for half in (image[200:-200, :middle].sum(axis=2), image[200:-200, middle:].sum(axis=2))
    ]
    assert abs(drawn[0] - drawn[1]) < 0.02 * image.shape[0]
    fine, coarse = (face_curvature(mesh).mean() for mesh in (before, after))
    assert f"{fine:.2f}° before, {coarse:.2f}° after" in figure.caption
    assert coarse > 4 * fine


def test_what_moved_is_dark_on_the_map() -> None:
    before = sphere(30.0, 4)
    frame = find_body_frame(before)
    moved = before.vertices * np.where(before.vertices @ frame.right < 0, 1.0, 1.05)[:, None]
    image = picture(draw_deviation_map("skin", measure_deviation(before, before.with_vertices(moved)), frame).png)
    first_view = image[: image.shape[0] // 2, : image.shape[1] // 2]
    row = first_view[first_view.shape[0] // 2]
    painted = np.flatnonzero(row.sum(axis=1) < 740)
    middle = (painted[0] + painted[-1]) // 2
    green = row[:, 1]
    assert green[middle + 30 : painted[-1] - 30].mean() < 0.5 * green[painted[0] + 30 : middle - 30].mean()


def test_a_set_gets_its_sections_and_a_broken_surface_its_places() -> None:
    originals = {"skin": sphere(30.0, 3), "fat": sphere(29.0, 3)}
    results = {"skin": sphere(30.1, 2), "fat": without_faces(sphere(28.5, 2), [0])}
    validation = validate(results)
    finding = Finding(
        code="mesh.not_closed",
        severity=Severity.ERROR,
        message="a hole",
        count=1,
        places=(Place(mesh="fat", point_mm=(0.0, 0.0, 28.0)),),
    )
    report = Report(
        process="decimate",
        verdict="not_ready",
        summary="",
        meshes=validation.meshes,
        pairs=validation.pairs,
        findings=(finding,),
    )
    deviations = {name: measure_deviation(originals[name], results[name]) for name in results}
    figures = draw_comparison(originals, deviations, report)
    assert [figure.name for figure in figures] == [
        *("curvature_skin", "deviation_skin", "curvature_fat", "deviation_fat"),
        *("surface", "sections", "gap_places", "quality_histogram"),
    ]
    assert draw_comparison(originals, deviations, report) == figures
    for figure in figures:
        assert 60 < len(figure.caption) < 600
        assert picture(figure.png).std() > 5


def test_curvature_is_not_drawn_twice_where_nearly_all_is_as_it_was() -> None:
    before = sphere(30.0, 3)
    after = before.with_vertices(np.where(before.vertices[:, :1] > 28, 1.05 * before.vertices, before.vertices))
    validation = validate({"skin": after})
    report = Report(process="heal", verdict="simulation_ready", summary="", meshes=validation.meshes)
    figures = draw_comparison({"skin": before}, {"skin": measure_deviation(before, after)}, report)
    assert [figure.name for figure in figures] == ["deviation_skin", "quality_histogram"]
