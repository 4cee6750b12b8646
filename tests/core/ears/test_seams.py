"""Canals cut into the real body, and their seams."""

from functools import cache

import numpy as np
import pytest

from core.ears.canal import make_canal
from core.ears.concha import find_concha
from core.ears.cut_canals import cut_canals
from core.ears.find_ears import find_ears
from core.ears.remesh_seam import remesh_seams
from core.errors import InputError
from core.geometry.cut_surface import SKIN, CutSurface
from core.geometry.distance import closest_points
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.quality import quality
from core.geometry.seams import RemeshedSurface
from core.mesh import Mesh
from core.validation.requirements import require_fit_skin
from core.validation.validate import validate
from subjects.body import body
from tests.solids import cube, flipped, sphere, together, without_faces

UP = np.array([0.0, 1.0, 0.0])
BALL = sphere(50.0, 4)


@cache
def generated(subdivisions: int) -> dict[str, Mesh]:
    skin = body(subdivisions)
    return {
        ear.name: make_canal(skin.vertices[find_concha(skin, ear, UP)], -ear.outward, UP).rounded_to_float32()
        for ear in find_ears(skin)
    }


@cache
def cut(subdivisions: int) -> CutSurface:
    return cut_canals(body(subdivisions), generated(subdivisions))


@cache
def remeshed(subdivisions: int) -> RemeshedSurface:
    return remesh_seams(cut(subdivisions), body(subdivisions), tuple(generated(subdivisions).values()))


@pytest.mark.parametrize("subdivisions", [0, 1])
def test_canals_begin_in_the_hollow_behind_the_tragus(subdivisions):
    skin = body(subdivisions)
    for ear in find_ears(skin):
        x, y, z = skin.vertices[find_concha(skin, ear, UP)]
        assert 66 < abs(x) < 71
        assert 700 < y < 714
        assert 50 < z < 60


def test_other_faces_stay_bit_for_bit():
    skin, result = body(0), remeshed(0)
    kept = {corners.tobytes() for corners in result.mesh.triangles()[: result.kept]}
    before = [corners.tobytes() for corners in skin.triangles()]
    assert len(kept) == result.kept > len(skin.faces) - 300
    # in their old order too
    assert [corners for corners in before if corners in kept] == [
        corners.tobytes() for corners in result.mesh.triangles()[: result.kept]
    ]


@pytest.mark.parametrize("subdivisions", [0, 1])
def test_seams_are_good_exactly_clean_and_where_they_were(subdivisions):
    skin, canals, result = body(subdivisions), generated(subdivisions), remeshed(subdivisions)
    before, after = cut(subdivisions).mesh, result.mesh
    assert quality(before.vertices, before.faces).min() < 0.01  # what the subtraction leaves
    assert quality(after.vertices, after.faces[result.kept :]).min() == pytest.approx(result.lowest_quality)
    assert result.lowest_quality >= 0.1
    require_fit_skin(after, "skin")
    assert validate({"skin": after}).meshes["skin"].genus == 0
    assert (after.vertices == after.vertices.astype(np.float32)).all()
    assert len(find_intersecting_faces(after.vertices, after.faces)) == 0
    given = Mesh.of(
        np.vstack([skin.vertices, *(canal.vertices for canal in canals.values())]),
        together(skin, *canals.values()).faces,
    )
    new = after.vertices[np.unique(after.faces[result.kept :])]
    assert closest_points(given.vertices, given.faces, new)[0].max() <= result.moved_mm < 0.25


def test_the_wall_is_the_canals():
    result = remeshed(0)
    for number, canal in enumerate(generated(0).values()):
        wall = result.mesh.vertices[np.unique(result.mesh.faces[result.piece == number])]
        assert closest_points(canal.vertices, canal.faces, wall)[0].max() <= result.moved_mm
    assert set(result.piece.tolist()) == {SKIN, 0, 1}
    removed = validate({"skin": body(0)}).meshes["skin"].volume_mm3 - validate({"skin": result.mesh}).meshes["skin"].volume_mm3
    assert removed == pytest.approx(2 * np.pi * 3.5**2 * 25, rel=0.1)


@pytest.mark.parametrize("around", [8, 40])
def test_coarse_and_fine_canals_in_a_ball(around):
    canal = make_canal((50, 0, 0), (-1, 0, 0), (0, 1, 0), around=around).rounded_to_float32()
    skin = BALL.rounded_to_float32()
    result = remesh_seams(cut_canals(skin, {"canal": canal}), skin, (canal,))
    require_fit_skin(result.mesh, "skin")
    assert result.lowest_quality >= 0.1


REFUSALS = {
    "canal.not_closed": without_faces(sphere(5.0, 2, at=(50, 0, 0)), [3]),
    "canal.unfit": flipped(sphere(5.0, 2, at=(50, 0, 0))),
    "canal.misses_skin": sphere(5.0, 2, at=(70, 0, 0)),
    "canal.pierces_skin": make_canal((50, 0, 0), (-1, 0, 0), (0, 1, 0), length_mm=120.0),
    "canal.splits_skin": sphere(5.0, 2),
}


@pytest.mark.parametrize("code", REFUSALS)
def test_canals_that_cannot_be_cut_are_refused_by_name(code):
    with pytest.raises(InputError, match="canal 'left'") as caught:
        cut_canals(BALL, {"left": REFUSALS[code]})
    assert caught.value.code == code
    assert caught.value.facts["canal"] == "left"


@pytest.mark.parametrize(
    ("canal", "code"),
    [
        (cube(300.0, at=(-150, -150, -150)), "canal.splits_skin"),
        (together(sphere(5.0, 2, at=(50, 0, 0)), sphere(5.0, 2, at=(-50, 0, 0))), "canal.unfit"),
    ],
    ids=["all", "two at once"],
)
def test_canals_that_are_no_canals(canal, code):
    with pytest.raises(InputError) as caught:
        cut_canals(BALL, {"left": canal})
    assert caught.value.code == code


def test_a_cut_through_leaves_two_bodies():
    plate = Mesh.of(cube(1.0).vertices * (10, 200, 200) + (-5, -100, -100), cube(1.0).faces)
    with pytest.raises(InputError, match="2 surfaces") as caught:
        cut_canals(BALL, {"left": plate})
    assert caught.value.code == "canal.splits_skin"
