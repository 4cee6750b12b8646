"""The whole of `heal`: what it promises on solids of every kind, on the real body, and its refusals by name."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.healing.fitness import find_faults
from core.healing.heal import heal
from core.mesh import Mesh
from subjects import body as real
from subjects.people import person
from subjects.touching import arms_lowered
from tests.core.healing.asked import healed, inputs, kinds, require_same
from tests.solids import cube, moebius_strip, octahedron, sphere, tetrahedron, torus, without_faces

SOLIDS = (tetrahedron(10.0), cube(10.0), octahedron(10.0), sphere(10.0, 2), torus(10.0, 3.0))


def together(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)]
    return Mesh.of(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def flipped(mesh: Mesh) -> Mesh:
    return Mesh.of(mesh.vertices, mesh.faces[:, ::-1])


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_fit_surface_comes_back_byte_for_byte(solid: Mesh) -> None:
    mesh = solid.rounded_to_float32()
    made = heal(mesh, inputs())
    require_same(made.mesh, mesh)
    assert made.changes == ()
    assert np.array_equal(made.former, np.arange(len(mesh.faces)))


def test_coordinates_are_rounded_to_what_files_hold() -> None:
    made = heal(sphere(10.0, 1), inputs())
    require_same(made.mesh, sphere(10.0, 1).rounded_to_float32())
    assert made.changes[0]["kind"] == "rounding"
    assert 0.0 < made.changes[0]["max_distance_mm"] < 1e-6


@st.composite
def damaged(draw: st.DrawFn) -> Mesh:
    """A solid with faces taken out, doubled, turned, torn off and given needless corners."""
    solid = draw(st.sampled_from(SOLIDS[2:])).rounded_to_float32()
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = len(solid.faces)
    faces = solid.faces.astype(np.int64)
    doubled = faces[generator.choice(count, draw(st.integers(0, 3)), replace=False)]
    gone = generator.choice(count, draw(st.integers(0, max(1, count // 16))), replace=False)
    faces = np.concatenate((np.delete(faces, gone, axis=0), np.roll(doubled, 1, axis=1), doubled[:, [0, 1, 1]]))
    turned = generator.random(len(faces)) < draw(st.sampled_from([0.0, 0.2]))
    faces[turned] = faces[turned][:, ::-1]
    if draw(st.booleans()):  # every face alone
        return Mesh.of(solid.vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    return Mesh.of(solid.vertices, faces)


@settings(max_examples=60)
@given(damaged())
def test_what_is_healed_is_ready_and_stays_as_it_is(mesh: Mesh) -> None:
    codes = ("heal.nothing_left", "heal.open_sheet", "heal.changes_too_much", "heal.intersections_remain")
    try:
        healed(mesh, max_area_change=1.0, max_volume_change=1.0, max_deviation_mm=100.0)
    except InputError as refusal:
        if refusal.code not in codes:
            raise


@settings(max_examples=15)
@given(damaged())
def test_the_same_input_gives_the_same_bytes(mesh: Mesh) -> None:
    options: dict[str, Any] = {"max_area_change": 1.0, "max_volume_change": 1.0, "max_deviation_mm": 100.0}
    try:
        first = heal(mesh, inputs(**options))
    except InputError:
        return
    second = heal(mesh, inputs(**options))
    require_same(first.mesh, second.mesh)
    assert first.changes == second.changes


def test_untouched_faces_of_the_real_body_keep_their_corners() -> None:
    body = real.body()
    generator = np.random.default_rng(4)
    faces = np.delete(body.faces, generator.choice(len(body.faces), 30, replace=False), axis=0)
    faces = np.concatenate((faces, faces[:20, [1, 2, 0]], faces[40:60, [0, 0, 1]]))
    made = healed(Mesh.of(body.vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)))
    assert (made.former >= 0).sum() >= len(body.faces) - 30
    assert kinds(made)[:3] == ["equal_vertices", "degenerate_faces", "duplicate_faces"]
    volume = [
        float(np.einsum("ij,ij->", mesh.triangles()[:, 0], np.cross(mesh.triangles()[:, 1], mesh.triangles()[:, 2])))
        for mesh in (body, made.mesh)
    ]
    assert volume[1] == pytest.approx(volume[0], rel=1e-4)


def test_every_change_has_its_places_and_distances() -> None:
    mesh = without_faces(sphere(10.0, 3).rounded_to_float32(), [3, 200])
    made = healed(mesh)
    holes = next(change for change in made.changes if change["kind"] == "holes")
    assert holes["count"] == len(holes["places"]) == 2
    assert {round(float(np.linalg.norm(place["point_mm"]))) for place in holes["places"]} == {10}
    extent = made.changes[-1]
    assert extent["faces_kept"] == len(mesh.faces)
    assert (extent["lost_mm"], extent["gained_mm"]) == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize(
    ("policy", "options", "pieces"),
    [
        ("keep_largest", {"max_area_change": 1.0}, 1),
        ("keep_above", {"min_piece_share": 0.3, "max_area_change": 1.0}, 2),
        ("keep_above", {"min_piece_share": 0.001}, 3),
        ("keep_all", {}, 3),
    ],
)
def test_pieces_stay_as_the_policy_says(policy: str, options: dict[str, Any], pieces: int) -> None:
    mesh = together(sphere(10.0, 2), sphere(6.0, 2, (30, 0, 0)), sphere(1.0, 1, (0, 30, 0))).rounded_to_float32()
    made = healed(mesh, pieces=policy, **options)
    assert len(made.mesh.faces) == sum(len(sphere(1.0, s).faces) for s in (2, 2, 1)[:pieces])


def test_a_large_piece_is_not_dropped_silently() -> None:
    mesh = together(sphere(10.0, 2), sphere(9.0, 2, (30, 0, 0))).rounded_to_float32()
    with pytest.raises(InputError) as refusal:
        heal(mesh, inputs())
    assert refusal.value.code == "heal.changes_too_much"
    assert refusal.value.facts["area_taken"] == pytest.approx(81 / 181, rel=1e-6)


@pytest.mark.parametrize("inner_turned", [False, True])
@pytest.mark.parametrize("outer_turned", [False, True])
def test_cavities_look_into_their_hollow_whichever_way_they_came(outer_turned: bool, inner_turned: bool) -> None:
    outer, inner = sphere(10.0, 2), sphere(4.0, 2)
    mesh = together(flipped(outer) if outer_turned else outer, flipped(inner) if inner_turned else inner).rounded_to_float32()
    made = healed(mesh, pieces="keep_all")
    right = together(outer, flipped(inner)).rounded_to_float32()
    assert {tuple(sorted(face)) for face in made.mesh.faces.tolist()} == {tuple(sorted(face)) for face in right.faces.tolist()}
    assert len(kinds(made)) == int(outer_turned or not inner_turned)


def test_smoothing_of_steps_moves_no_vertex_farther_than_allowed() -> None:
    mesh = sphere(10.0, 3).rounded_to_float32()
    bumpy = mesh.with_vertices(mesh.vertices * (1 + 0.03 * np.sin(9 * mesh.vertices[:, :1]))).rounded_to_float32()
    made = healed(bumpy, staircase=True, staircase_max_mm=0.2)
    way = np.linalg.norm(made.mesh.vertices - bumpy.vertices, axis=1)
    assert 0.1 < way.max() <= 0.2
    assert np.std(np.linalg.norm(made.mesh.vertices, axis=1)) < np.std(np.linalg.norm(bumpy.vertices, axis=1))


REFUSALS = [
    (Mesh.of([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]), {}, "heal.nothing_left"),
    (moebius_strip(), {}, "heal.one_sided"),
    (without_faces(cube(10.0), [0]), {"fill_holes": False}, "heal.holes_not_allowed"),
    (without_faces(cube(10.0), [0]), {"max_hole_mm": 30.0}, "heal.hole_too_large"),
    (without_faces(cube(10.0), [0, 1, 2, 3, 4, 5]), {"max_area_change": 0.2}, "heal.changes_too_much"),
    (Mesh.of([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]), {}, "heal.open_sheet"),
]


@pytest.mark.parametrize(("mesh", "options", "code"), REFUSALS)
def test_refuses_by_name(mesh: Mesh, options: dict[str, Any], code: str) -> None:
    with pytest.raises(InputError) as refusal:
        heal(mesh, inputs(**options))
    assert refusal.value.code == code


def test_the_input_is_left_alone() -> None:
    mesh = without_faces(sphere(10.0, 2).rounded_to_float32(), [5])
    vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
    heal(mesh, inputs())
    assert np.array_equal(mesh.vertices, vertices)
    assert np.array_equal(mesh.faces, faces)


def test_an_arm_in_the_torso_up_to_the_armpit_is_united_and_not_smoothed_away() -> None:
    skin = person(turns=arms_lowered(42.0)).rounded_to_float32()
    made = heal(skin, inputs())
    assert kinds(made) == ["overlaps"]
    assert (made.former >= 0).sum() > 0.98 * len(skin.faces)
    assert made.changes[-1]["lost_mm"] < 0.1
    assert find_faults(made.mesh) == ()
