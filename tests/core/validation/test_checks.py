"""Every check passes sound solids and rejects a mesh made for it, with counts and places found by hand."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from core.mesh import Mesh
from core.schema.finding import MAX_PLACES, Finding, Severity
from core.validation.closed import check_closed
from core.validation.components import check_components
from core.validation.faces import check_degenerate_faces, check_duplicate_faces
from core.validation.manifold import check_edge_manifold, check_vertex_manifold
from core.validation.orientation import check_orientation, check_outward
from core.validation.self_intersection import check_self_intersection
from core.validation.shape import check_dihedral, check_quality
from core.validation.surface import Surface
from core.validation.validate import CHECKS
from core.validation.vertices import check_coincident_vertices, check_unused_vertices
from tests.solids import (
    cube,
    flipped,
    moebius_strip,
    octahedron,
    sphere,
    tetrahedron,
    together,
    torus,
    with_faces,
    without_faces,
)

Check = Callable[[Surface], list[Finding]]
TWO_FACES = [[0, 1, 2], [1, 0, 3]]


def hinge(tip: list[float]) -> Mesh:
    """Two faces that share the edge from (0, 0, 0) to (1, 0, 0)."""
    return Mesh.of([[0, 0, 0], [1, 0, 0], [0.5, 1, 0], tip], TWO_FACES)


def welded(mesh: Mesh) -> Mesh:
    """Vertices at one place joined."""
    places, number = np.unique(mesh.vertices, axis=0, return_inverse=True)
    return Mesh.of(places, number.reshape(-1)[mesh.faces])


def book() -> Mesh:
    """Three faces on one edge."""
    return Mesh.of([[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 1, 0], [-1, -1, 0]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])


@dataclass(frozen=True)
class Case:
    """A mesh and the count the check must give."""

    check: Check
    mesh: Mesh
    code: str
    count: int
    faces: set[int] | None = None  # all faces named by the places
    vertices: set[int] | None = None
    places: int | None = None


def _cases() -> dict[str, Case]:
    two_tips = welded(together(tetrahedron(), tetrahedron(-1.0)))
    line = Mesh.of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], [[0, 1, 2], [0, 1, 3], [0, 2, 2]])
    return {
        "a missing face": Case(
            check_closed, without_faces(cube(), [3]), "mesh.not_closed", 3, faces={2, 3, 9}, vertices={4, 5, 7}, places=1
        ),
        "two holes": Case(check_closed, without_faces(sphere(1.0, 2), [0, 127]), "mesh.not_closed", 6, places=2),
        "one face alone": Case(check_closed, Mesh.of(np.eye(3), [[0, 1, 2]]), "mesh.not_closed", 3, vertices={0, 1, 2}),
        "the rim of a Möbius strip": Case(check_closed, moebius_strip(8), "mesh.not_closed", 16, places=1),
        "three faces on an edge": Case(
            check_edge_manifold, book(), "mesh.edge_not_manifold", 1, faces={0, 1, 2}, vertices={0, 1}
        ),
        "a wall inside a cube": Case(
            check_edge_manifold, with_faces(cube(), [[0, 3, 7], [0, 7, 4]]), "mesh.edge_not_manifold", 4, places=4
        ),
        "a bow tie": Case(
            check_vertex_manifold,
            Mesh.of([[0, 0, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [-1, 1, 0]], [[0, 1, 2], [0, 3, 4]]),
            "mesh.vertex_not_manifold",
            1,
            vertices={0},
        ),
        "two tetrahedra tip to tip": Case(
            check_vertex_manifold,
            two_tips,
            "mesh.vertex_not_manifold",
            1,
            vertices={int(np.flatnonzero((two_tips.vertices == 0).all(axis=1))[0])},
        ),
        "a turned face": Case(check_orientation, flipped(cube(), [5]), "mesh.not_oriented", 3, places=3),
        "a Möbius strip": Case(check_orientation, moebius_strip(), "mesh.not_oriented", 1),
        "an inside-out sphere": Case(check_outward, flipped(sphere()), "mesh.inside_out", 1, faces={0}),
        "a cavity that looks outward": Case(
            check_outward, together(sphere(3.0, 1), sphere(1.0, 1)), "mesh.inside_out", 1, faces={32}
        ),
        "one of two bodies inside out": Case(
            check_outward, together(cube(), flipped(cube(at=(5, 0, 0)))), "mesh.inside_out", 1, faces={12}
        ),
        "no area": Case(check_degenerate_faces, line, "mesh.degenerate_faces", 2, faces={1, 2}),
        "a face twice": Case(check_duplicate_faces, with_faces(cube(), [cube().faces[2]]), "mesh.duplicate_faces", 1, faces={12}),
        "a face twice, the other way round": Case(
            check_duplicate_faces, with_faces(cube(), [cube().faces[2][::-1]]), "mesh.duplicate_faces", 1, faces={12}
        ),
        "a crack": Case(
            check_coincident_vertices, together(hinge([0.5, -1, 0]), hinge([0.5, -1, 1])), "mesh.coincident_vertices", 3
        ),
        "two bodies touching at a corner": Case(
            check_coincident_vertices, together(cube(), cube(at=(1, 1, 1))), "mesh.coincident_vertices", 1, vertices={8}
        ),
        "an idle vertex": Case(
            check_unused_vertices,
            Mesh.of([[9, 9, 9], *cube().vertices], cube().faces + 1),
            "mesh.unused_vertices",
            1,
            vertices={0},
        ),
        "folded over flat": Case(check_self_intersection, hinge([0.5, 0.5, 0]), "mesh.self_intersecting", 1, faces={0, 1}),
        "two crossing pieces": Case(
            # as in the tests of the exact call: three sides of the small one cross the bottom of the big one
            check_self_intersection,
            together(tetrahedron(), tetrahedron(0.2, at=(0.2, 0.2, -0.1))),
            "mesh.self_intersecting",
            3,
            faces={0, 5, 6, 7},
            places=1,
        ),
        "two places of crossing": Case(
            check_self_intersection,
            together(
                tetrahedron(),
                tetrahedron(0.2, at=(0.2, 0.2, -0.1)),
                tetrahedron(1.0, at=(9, 0, 0)),
                tetrahedron(0.2, at=(9.2, 0.2, -0.1)),
            ),
            "mesh.self_intersecting",
            6,
            faces={0, 5, 6, 7, 8, 13, 14, 15},
            places=2,
        ),
        "three pieces": Case(
            check_components,
            together(sphere(3.0, 1), flipped(octahedron()), tetrahedron(at=(5, 0, 0))),
            "mesh.several_components",
            3,
            faces={0, 32, 40},
        ),
        "a needle": Case(
            check_quality, Mesh.of([[0, 0, 0], [2, 0, 0], [1, 0.01, 0]], [[0, 1, 2]]), "mesh.quality_low", 1, faces={0}
        ),
        "a sharp fold": Case(check_dihedral, hinge([0.5, 1, 1e-3]), "mesh.fold_too_sharp", 1, faces={0, 1}, vertices={0, 1}),
    }


CASES = _cases()


@pytest.mark.parametrize("name", CASES)
def test_rejected(name: str) -> None:
    case = CASES[name]
    (finding,) = case.check(Surface("thing", case.mesh))
    assert finding.code == case.code
    assert finding.count == case.count
    assert "thing" in finding.message
    assert 1 <= len(finding.places) <= MAX_PLACES
    assert {place.mesh for place in finding.places} == {"thing"}
    if case.places is not None:
        assert len(finding.places) == case.places
    if case.faces is not None:
        assert {face for place in finding.places for face in place.faces} == case.faces
    if case.vertices is not None:
        assert {vertex for place in finding.places for vertex in place.vertices} == case.vertices
    low, high = case.mesh.vertices.min(axis=0), case.mesh.vertices.max(axis=0)
    for place in finding.places:
        assert (low - 1e-6 <= place.point_mm).all()
        assert (place.point_mm <= high + 1e-6).all()


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_sound_solids_pass(check: Check) -> None:
    hollow = together(sphere(3.0), flipped(sphere(2.0)), sphere(1.0))
    for mesh in (tetrahedron(), cube(), octahedron(), sphere(2.0, 3), torus()):
        assert check(Surface("solid", mesh)) == []
    assert [finding.severity for finding in check(Surface("hollow", hollow))] in ([], [Severity.INFO])


def test_every_check_has_a_mesh_it_rejects() -> None:
    assert {case.check for case in CASES.values()} == set(CHECKS)


def test_a_hole_is_placed_in_its_middle() -> None:
    (finding,) = check_closed(Surface("box", without_faces(cube(2.0), [0, 1])))
    assert finding.places[0].point_mm == (0.0, 1.0, 1.0)
    assert finding.count == 4


def test_messages_say_what_would_mend_it() -> None:
    assert "flipping 1 face would" in check_orientation(Surface("a", flipped(cube(), [5])))[0].message
    assert "one-sided" in check_orientation(Surface("a", moebius_strip()))[0].message
    assert "1 of them are cavities" in check_outward(Surface("a", together(sphere(3.0), sphere(1.0))))[0].message


def test_places_are_few_however_many_faults() -> None:
    soup = Mesh.of(np.random.default_rng(7).normal(size=(900, 3)), np.arange(900).reshape(-1, 3))
    for check in CHECKS:
        for finding in check(Surface("soup", soup)):
            assert len(finding.places) <= MAX_PLACES
            assert max(len(place.faces) for place in finding.places) <= MAX_PLACES
    assert check_self_intersection(Surface("soup", soup))[0].count > MAX_PLACES


def test_worst_places_come_first() -> None:
    needles = [Mesh.of([[0, 0, 0], [2, 0, 0], [1, height, 0]], [[0, 1, 2]]) for height in (0.01, 0.001, 0.005)]
    (finding,) = check_quality(Surface("needles", together(*needles)))
    assert [place.faces for place in finding.places] == [(1,), (2,), (0,)]


def test_faces_that_are_no_triangles_join_nothing() -> None:
    # the line 0-1-1 lies along the rim and must not close it
    mesh = with_faces(without_faces(cube(), [3]), [[4, 5, 5], [4, 4, 4]])
    assert check_closed(Surface("box", mesh))[0].count == 3
    assert check_edge_manifold(Surface("box", mesh)) == []
    assert check_degenerate_faces(Surface("box", mesh))[0].count == 2


def test_nothing_but_lines() -> None:
    lines = Mesh.of(np.eye(3), [[0, 1, 1], [2, 2, 2]])
    assert [finding.code for check in CHECKS for finding in check(Surface("lines", lines))] == ["mesh.degenerate_faces"]
