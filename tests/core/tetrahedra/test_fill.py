"""Filled sets have the volumes of their closed forms; what is not filled wholly is found out."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from core.errors import InputError, InternalError
from core.mesh import Mesh
from core.tetrahedra.element_quality import quality, volumes
from core.tetrahedra.fill import fill
from core.tetrahedra.forked import Filling
from core.tetrahedra.prove_filled import expected_volumes, prove_filled
from core.tetrahedra.regions import spread_regions
from core.tetrahedra.tetgen import Facets
from core.tetrahedra.tetgen_ways import Way, fill_facets
from tests.core.tetrahedra.refused_by_tetgen import tetgen_refuses
from tests.solids import cube, flipped, sphere, together

SURFACES = {"outer": sphere(10.0, 2), "inner": sphere(8.0, 2), "core": sphere(3.0, 1)}
NESTING = {"outer": None, "inner": "outer", "core": "inner"}


@pytest.fixture(scope="module", params=["tetgen", "gmsh"])
def mesher(request):
    return request.param


@pytest.fixture(scope="module")
def filled(mesher):
    return fill(SURFACES, NESTING, gap_mm=0.5, mesher=mesher)


def test_every_tissue_has_its_volume(filled):
    found = np.bincount(filled.region, weights=volumes(filled.corners()))
    whole = [float(mesh_volume(mesh)) for mesh in SURFACES.values()]
    np.testing.assert_allclose(found, [whole[0] - whole[1], whole[1] - whole[2], whole[2]], rtol=1e-10)


def test_vertices_of_the_surfaces_come_first_and_unchanged(filled):
    given = np.vstack([mesh.vertices for mesh in SURFACES.values()])
    np.testing.assert_array_equal(filled.vertices[: len(given)], given)


def test_the_same_comes_of_the_same(filled, mesher):
    again = fill(SURFACES, NESTING, gap_mm=0.5, mesher=mesher)
    np.testing.assert_array_equal(again.vertices, filled.vertices)
    np.testing.assert_array_equal(again.tetrahedra, filled.tetrahedra)


def test_a_better_shape_takes_more_tetrahedra():
    filled = fill(SURFACES, NESTING, gap_mm=0.5)
    better = fill(SURFACES, NESTING, gap_mm=0.5, radius_edge=1.1)
    assert len(better.tetrahedra) > len(filled.tetrahedra)
    inner = [np.median(quality(each.corners()[each.region == 1])) for each in (filled, better)]
    assert inner[1] > inner[0]


def test_a_largest_volume_makes_its_tissue_finer_and_no_other(mesher):
    surfaces = {"outer": SURFACES["outer"], "inner": sphere(8.0, 3)}
    nesting = {"outer": None, "inner": "outer"}
    coarse = fill(surfaces, nesting, gap_mm=0.5, mesher=mesher, radius_edge=2.0)
    fine = fill(surfaces, nesting, gap_mm=0.5, mesher=mesher, radius_edge=2.0, largest_mm3={"inner": 0.25})
    assert (fine.region == 1).sum() > 3 * (coarse.region == 1).sum()
    assert (fine.region == 0).sum() < 1.1 * (coarse.region == 0).sum()
    assert np.median(volumes(fine.corners())[fine.region == 1]) <= 0.25


def test_siblings_and_pieces_share_the_tissue_around_them(mesher):
    surfaces = {
        "outer": cube(40.0),
        "pair": together(sphere(3.0, 1, at=(10.0, 10.0, 10.0)), sphere(3.0, 1, at=(30.0, 10.0, 10.0))),
        "third": sphere(2.0, 1, at=(20.0, 10.0, 10.0)),
    }
    volume = fill(surfaces, {"outer": None, "pair": "outer", "third": "outer"}, gap_mm=0.5, mesher=mesher)
    assert np.bincount(volume.region, weights=volumes(volume.corners()))[0] == pytest.approx(
        64000 - mesh_volume(surfaces["pair"]) - mesh_volume(surfaces["third"])
    )


def test_a_cavity_belongs_to_the_tissue_around_or_to_nobody(mesher):
    hollow = sphere(4.0, 2)
    surfaces = {"outer": SURFACES["outer"], "hollow": together(hollow, flipped(sphere(2.0, 1)))}
    volume = fill(surfaces, {"outer": None, "hollow": "outer"}, gap_mm=0.5, mesher=mesher)
    assert np.linalg.norm(volume.corners().mean(axis=1), axis=1)[volume.region == 0].min() < 2.0
    alone = fill({"hollow": surfaces["hollow"]}, {"hollow": None}, gap_mm=0.5, mesher=mesher)
    assert volumes(alone.corners()).sum() == pytest.approx(mesh_volume(hollow) - mesh_volume(sphere(2.0, 1)))


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ("tetgen", r"TetGen .* 6 ways to ask it. `mesher` gmsh may fill them"),
        ("auto", r"TetGen .* 6 ways to ask it. Then gmsh was asked: the tetrahedra made do not pass the proof"),
    ],
)
def test_crossing_surfaces_are_refused_by_name_and_the_caller_lives(asked, words):
    crossing = {"a": sphere(5.0, 2), "b": sphere(1.5, 2, at=(4.9, 0.0, 0.0))}
    with pytest.raises(InputError, match=words) as error:
        fill(crossing, {"a": None, "b": "a"}, gap_mm=0.5, mesher=asked)
    assert error.value.code == "tetrahedra.refused"


def test_gmsh_fills_a_flat_side_cut_anyhow_that_tetgen_would_put_a_vertex_on():
    surfaces, nesting = tetgen_refuses()
    with pytest.raises(InputError) as error:
        fill(surfaces, nesting, gap_mm=0.1, mesher="tetgen")
    assert error.value.code == "tetrahedra.refused"
    volume = fill(surfaces, nesting, gap_mm=0.1)
    assert volume.mesher == "gmsh"
    assert np.unique(volume.region).tolist() == [0, 1]


def test_tetgen_is_asked_first():
    assert fill(SURFACES, NESTING, gap_mm=0.5).mesher == "tetgen"


def test_where_gmsh_is_not_there_tetgens_refusal_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "gmsh", None)  # so that it cannot be imported
    surfaces, nesting = tetgen_refuses()
    with pytest.raises(InputError, match=r"TetGen refuses.*gmsh cannot be used on this server.*apt-get install") as error:
        fill(surfaces, nesting, gap_mm=0.1)
    assert error.value.code == "tetrahedra.refused"


def test_what_is_too_thin_for_a_point_is_refused():
    ball = sphere(10.0, 2)
    with pytest.raises(InputError) as error:
        fill({"leaf": ball.with_vertices(ball.vertices * (1.0, 1.0, 1e-5))}, {"leaf": None}, gap_mm=0.5)
    assert error.value.code == "tetrahedra.no_room"


def test_a_tetrahedron_with_the_number_of_another_tissue_gets_its_own(filled):
    faces = np.vstack([mesh.faces + start for mesh, start in zip(SURFACES.values(), (0, 66, 132), strict=True)]).astype(np.int32)
    wrong = filled.region.copy()
    wrong[np.flatnonzero(wrong == 1)[::7]] = 0
    np.testing.assert_array_equal(spread_regions(filled.vertices, filled.tetrahedra, wrong, faces), filled.region)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda v: replace(v, tetrahedra=v.tetrahedra[1:], region=v.region[1:]), "mm³"),
        (lambda v: replace(v, tetrahedra=v.tetrahedra[:, [1, 0, 2, 3]]), "inverted"),
        (lambda v: replace(v, region=np.where(v.region == 2, 1, v.region).astype(np.int32)), "border"),
        (lambda v: replace(v, region=(2 - v.region).astype(np.int32)), "mm³"),
    ],
)
def test_the_proof_finds_what_is_wrong(filled, change, word):
    prove_filled(filled, SURFACES, NESTING)
    with pytest.raises(InternalError, match=word) as error:
        prove_filled(change(filled), SURFACES, NESTING)
    assert error.value.code == "tetrahedra.not_proven"


def mesh_volume(mesh: Mesh) -> float:
    return expected_volumes({"one": mesh}, {"one": None})["one"]


def test_what_one_way_refuses_the_next_one_fills(monkeypatch):
    monkeypatch.setattr("core.tetrahedra.tetgen_ways.WAYS", (Way(0.5),))
    with pytest.raises(InputError) as error:
        fill(SURFACES, NESTING, gap_mm=0.5, mesher="tetgen")  # whole spheres are flat to it
    assert error.value.code == "tetrahedra.refused"
    monkeypatch.setattr("core.tetrahedra.tetgen_ways.WAYS", (Way(0.5), Way(1e-12)))
    assert np.unique(fill(SURFACES, NESTING, gap_mm=0.5).region).tolist() == [0, 1, 2]


def test_what_one_way_makes_but_cannot_prove_the_next_one_makes():
    ball = sphere(10.0, 1)
    facets = Facets(ball.vertices, ball.faces, np.zeros((1, 3)), np.array([1]), np.zeros(1))
    asked: list[int] = []

    def proven_from_the_third_on(made: Filling) -> int:
        asked.append(len(made.tetrahedra))
        if len(asked) < 3:
            raise InternalError("tetrahedra.not_proven", "not yet")
        return len(asked)

    assert fill_facets(facets, "pYYAQ", proven_from_the_third_on) == 3
    with pytest.raises(InternalError, match="never"):
        fill_facets(facets, "pYYAQ", never_proven)


def never_proven(_made: Filling) -> None:
    raise InternalError("tetrahedra.not_proven", "never")


def test_what_was_turned_comes_back_where_it_was(monkeypatch, filled):
    monkeypatch.setattr("core.tetrahedra.tetgen_ways.WAYS", (Way(1e-12, 7.0),))
    turned = fill(SURFACES, NESTING, gap_mm=0.5, radius_edge=1.2)
    given = np.vstack([mesh.vertices for mesh in SURFACES.values()])
    np.testing.assert_array_equal(turned.vertices[: len(given)], given)
    assert len(turned.vertices) > len(given), "and those it adds, too: the proof of the volumes has passed"
    found = [np.bincount(each.region, weights=volumes(each.corners())) for each in (turned, filled)]
    np.testing.assert_allclose(*found, rtol=1e-9)
