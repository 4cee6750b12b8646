"""`separate`: small tissues whose overlap can be told by hand, and refusals by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError
from core.geometry.bisection import halve_longest_edges, longest_edges
from core.geometry.exact_intersection import find_intersecting_faces, find_intersecting_faces_between
from core.mesh import Mesh
from core.schema.separate import SeparateInputs
from core.separation import separate as module
from core.separation.separate import Separation, separate
from core.validation.validate import validate
from tests.solids import cube, sphere, together

GAP_MM = 0.1


def inputs(meshes: dict[str, Mesh], **asked: Any) -> SeparateInputs:
    references = {name: {"href": f"/v1/meshes/00000000-0000-0000-0000-{number:012d}"} for number, name in enumerate(meshes)}
    return SeparateInputs.model_validate({"meshes": references, **asked})


def separated(meshes: dict[str, Mesh], **asked: Any) -> Separation:
    return separate(meshes, inputs(meshes, **asked))


def require_apart(result: Separation, gap_mm: float = GAP_MM) -> None:
    found = validate({name: tissue.mesh for name, tissue in result.tissues.items()}, min_gap_mm=gap_mm)
    assert found.verdict == "simulation_ready", found.findings


def refusal(meshes: dict[str, Mesh], **asked: Any) -> InputError:
    with pytest.raises(InputError) as error:
        separated(meshes, **asked)
    return error.value


SIDE_BY_SIDE = {"a": sphere(5.0, 3), "b": sphere(5.0, 3, at=(9.0, 0.3, 0.1))}


def test_two_balls_side_by_side_share_the_way() -> None:
    result = separated(SIDE_BY_SIDE)
    require_apart(result)
    assert result.relations["a", "b"] == "beside"
    for tissue in result.tissues.values():
        # the balls overlap by 1 mm minus the height of the facets; each goes half of it and of the gap
        assert 0.4 < tissue.shift_mm.max() < 0.65
        assert (tissue.shift_mm == 0.0).mean() > 0.8


def test_the_fixed_one_keeps_every_bit_and_the_other_goes_all_the_way() -> None:
    result = separated(SIDE_BY_SIDE, fixed=["b"])
    require_apart(result)
    assert np.array_equal(result.tissues["b"].mesh.vertices, SIDE_BY_SIDE["b"].rounded_to_float32().vertices)
    assert result.tissues["a"].shift_mm.max() > 0.8


def test_priority_lets_the_other_go() -> None:
    result = separated(SIDE_BY_SIDE, priority={"a": 1})
    require_apart(result)
    assert not result.tissues["a"].shift_mm.any()
    assert result.tissues["b"].shift_mm.any()


def test_with_priority_one_helps_when_the_other_may_not_go_far_enough() -> None:
    result = separated(SIDE_BY_SIDE, priority={"a": 1}, max_shift_mm=0.8)
    require_apart(result)
    assert result.tissues["a"].shift_mm.any()
    assert max(tissue.shift_mm.max() for tissue in result.tissues.values()) < 0.8 + 1e-5


def test_the_inner_one_poking_out_is_drawn_in_and_the_outer_one_pushed_out() -> None:
    meshes = {"outer": sphere(5.0, 3), "inner": sphere(4.0, 3, at=(1.2, 0.3, 0.1))}
    assert len(find_intersecting_faces_between(meshes["outer"], meshes["inner"])) > 0
    result = separated(meshes)
    require_apart(result)
    assert result.relations["inner", "outer"] == "inside"
    out = result.tissues["outer"]
    grown = np.linalg.norm(out.mesh.vertices, axis=1) - np.linalg.norm(out.original.vertices, axis=1)
    assert grown.max() > 0.05
    assert grown.min() > -1e-6


def test_coincident_walls_of_nested_cubes_are_parted() -> None:
    result = separated({"outer": cube(10.0), "inner": cube(5.0, at=(0.0, 2.0, 2.0))})
    require_apart(result)


def test_touching_neighbours_of_equal_faces_are_parted() -> None:
    meshes = {"left": cube(10.0), "right": cube(10.0, at=(10.0, 0.0, 0.0))}
    result = separated(meshes)
    require_apart(result)
    assert all(tissue.shift_mm.max() < 2 * GAP_MM for tissue in result.tissues.values())


def test_five_tissues_at_once() -> None:
    meshes = {
        "skin": sphere(10.0, 3),
        "skull": sphere(9.97, 3),
        "left": sphere(5.0, 3, at=(-4.9, 0.1, 0.0)),
        "right": sphere(5.0, 3, at=(4.9, 0.0, 0.1)),
        "core": sphere(3.0, 2, at=(-6.85, 0.0, 0.0)),
    }
    result = separated(meshes, fixed=["skin"])
    require_apart(result)
    assert result.relations["core", "left"] == "inside"
    assert result.relations["left", "right"] == "beside"


def test_what_is_apart_is_not_touched() -> None:
    meshes = {"outer": sphere(5.0, 3), "inner": sphere(4.0, 2)}
    result = separated(meshes)
    assert not any(tissue.shift_mm.any() for tissue in result.tissues.values())


def plate(finest_mm: float = 60.0) -> Mesh:
    """40 x 40 x 2 mm, 12 faces or with no edge longer than that."""
    vertices, faces = cube(1.0).vertices * (40.0, 40.0, 2.0), cube(1.0).faces
    while (long := longest_edges(vertices, faces) > finest_mm).any():
        vertices, faces = halve_longest_edges(vertices, faces, long)
    return Mesh.of(vertices, faces)


PRESSED = {"plate": plate(), "up": sphere(6.0, 3, at=(12.0, 12.0, 6.8)), "down": sphere(6.0, 3, at=(28.0, 28.0, -4.8))}


def test_faces_too_large_to_bend_are_halved_where_it_matters() -> None:
    result = separated(PRESSED, fixed=["up", "down"])
    require_apart(result)
    made = result.tissues["plate"]
    assert 0 < made.faces_added == len(made.mesh.faces) - 12
    assert np.array_equal(made.original.vertices[:8], PRESSED["plate"].vertices)
    assert made.original.faces.shape == made.mesh.faces.shape
    assert all(result.tissues[name].faces_added == 0 for name in ("up", "down"))


def test_the_refusal_tells_the_edge_that_would_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_REFINEMENTS", 0)
    error = refusal(PRESSED, fixed=["up", "down"])
    assert error.code == "separate.no_room"
    needed = float(error.facts["edge_needed_mm"])
    # each ball reaches 1 mm less the height of its facets into the plate, over a cap 6.6 mm wide
    assert 2.0 < needed < 6.6
    assert f"edges of at most {needed:.2g} mm" in error.message
    assert "0.96 mm deep in one another with edges up to 56.6 mm" in error.findings[0].message
    result = separated({**PRESSED, "plate": plate(finest_mm=needed)}, fixed=["up", "down"])
    require_apart(result)
    assert result.tissues["plate"].faces_added == 0


def test_no_edge_is_named_where_faces_are_not_what_stands_in_the_way() -> None:
    fine = {"a": sphere(5.0, 4), "b": sphere(5.0, 4, at=(9.0, 0.3, 0.1))}
    error = refusal(fine, fixed=["a", "b"])
    assert "edge_needed_mm" not in error.facts
    assert "edges" not in error.message


def test_same_input_same_bytes() -> None:
    first, second = separated(SIDE_BY_SIDE), separated(SIDE_BY_SIDE)
    for name in SIDE_BY_SIDE:
        assert first.tissues[name].mesh.vertices.tobytes() == second.tissues[name].mesh.vertices.tobytes()


@given(seed=st.integers(0, 10_000), nested=st.booleans(), gap=st.sampled_from([0.05, 0.1, 0.3]))
@settings(max_examples=12)
def test_random_blobs(seed: int, nested: bool, gap: float) -> None:
    random = np.random.default_rng(seed)
    meshes = {"a": blob(5.0, random), "b": blob(3.2 if nested else 4.0, random)}
    away = random.normal(size=3)
    away *= (1.3 if nested else 8.2) / np.linalg.norm(away)
    meshes["b"] = meshes["b"].with_vertices(meshes["b"].vertices + away).rounded_to_float32()
    result = separated(meshes, min_gap_mm=gap, inside={"b": "a" if nested else None, "a": None})
    require_apart(result, gap)
    for tissue in result.tissues.values():
        assert len(find_intersecting_faces(tissue.mesh.vertices, tissue.mesh.faces)) == 0
        assert tissue.shift_mm.max() < 3.0


def blob(radius: float, random: np.random.Generator) -> Mesh:
    """A ball with waves on it."""
    ball = sphere(1.0, 3)
    waves = sum(0.04 * np.sin(ball.vertices @ random.normal(size=3) * 3.0 + random.uniform(0, 6)) for _ in range(4))
    return ball.with_vertices(ball.vertices * (radius * (1.0 + np.asarray(waves)))[:, None]).rounded_to_float32()


def test_no_room_between_fixed_surfaces_is_refused_with_the_places() -> None:
    meshes = {"outer": sphere(5.0, 3), "middle": sphere(4.97, 3), "inner": sphere(4.94, 3)}
    error = refusal(meshes, fixed=["outer", "inner"])
    assert error.code == "separate.no_room"
    assert error.findings
    assert {place.mesh for finding in error.findings for place in finding.places} == set(meshes)


def test_two_fixed_surfaces_that_cross_are_refused() -> None:
    error = refusal(SIDE_BY_SIDE, fixed=["a", "b"])
    assert error.code == "separate.no_room"
    assert "fixed" in error.message


def test_max_shift_is_kept_or_refused() -> None:
    assert refusal(SIDE_BY_SIDE, max_shift_mm=0.2).code == "separate.no_room"


@pytest.mark.parametrize(
    ("meshes", "asked", "code"),
    [
        ({"a": sphere(5.0, 2), "b": sphere(5.0, 2)}, {}, "separate.identical"),
        ({"a": sphere(5.0, 2), "b": sphere(5.0, 2, at=(2.0, 0.0, 0.0))}, {}, "separate.unclear_sides"),
        ({"skin": sphere(5.0, 2), "b": sphere(1.0, 2, at=(9.0, 0.0, 0.0))}, {"inside": {"b": "skin"}}, "separate.not_inside"),
        ({"a": sphere(5.0, 2), "b": sphere(4.0, 2)}, {"inside": {"b": "a", "a": "b"}}, "separate.unordered"),
        ({"a": sphere(5.0, 2), "b": sphere(4.0, 2)}, {"fixed": ["c"]}, "separate.unknown_tissue"),
        (
            {"a": sphere(5.0, 2), "b": together(sphere(1.0, 2), sphere(1.0, 2, at=(9.0, 0.0, 0.0)))},
            {"inside": {"b": "a"}},
            "separate.partly_inside",
        ),
        (
            {"a": sphere(5.0, 2), "b": sphere(5.0, 2, at=(7.0, 0.0, 0.0)), "c": sphere(0.5, 2, at=(3.5, 0.0, 0.0))},
            {},
            "separate.unordered",
        ),
        ({"a": sphere(5.0, 2), "b": Mesh.of(cube(1.0).vertices, cube(1.0).faces[:, ::-1])}, {}, "surface.inside_out"),
    ],
)
def test_refusals_by_name(meshes: dict[str, Mesh], asked: dict[str, Any], code: str) -> None:
    assert refusal(meshes, **asked).code == code


def test_one_surface_alone_is_no_request() -> None:
    with pytest.raises(ValueError, match="two or more"):
        inputs({"a": cube(1.0)})
