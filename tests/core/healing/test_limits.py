"""How much changed: closed forms, and refusals with numbers."""

import numpy as np
import pytest

from core.errors import InputError
from core.healing.change import Change
from core.healing.enclosed_volume import piece_volumes
from core.healing.limits import Extent, find_former, measure_extent, require_within
from core.mesh import Mesh
from tests.core.healing.asked import inputs
from tests.solids import cube, sphere, without_faces


def extent(before: Mesh, after: Mesh, *changes: Change, volumes: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Extent:
    return measure_extent(before, after, find_former(before, after), list(changes), volumes)


def test_former_faces_are_found_by_their_places_whatever_their_numbers_and_direction() -> None:
    mesh = sphere(5.0, 1)
    generator = np.random.default_rng(1)
    vertices, faces = generator.permutation(len(mesh.vertices)), generator.permutation(len(mesh.faces))
    number = np.argsort(vertices)
    shuffled = Mesh.of(mesh.vertices[vertices], number[mesh.faces[faces]][:, [2, 1, 0]])
    assert np.array_equal(find_former(mesh, shuffled), faces)
    moved = shuffled.vertices.copy()
    moved[0] *= 1.0 + 1e-12
    former = find_former(mesh, shuffled.with_vertices(moved))
    assert np.array_equal(former == -1, (shuffled.faces == 0).any(axis=1))


def test_the_same_surface_has_no_extent() -> None:
    mesh = cube(2.0)
    assert extent(mesh, mesh) == Extent(12, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_what_is_pressed_in_is_gained_and_what_stood_out_is_lost() -> None:
    flat = sphere(10.0, 3)
    dented = flat.vertices.copy()
    dented[0] *= 0.9  # one millimetre inwards
    dent = flat.with_vertices(dented)
    pressed, raised = extent(flat, dent), extent(dent, flat)
    assert pressed.faces_kept == raised.faces_kept == len(flat.faces) - 4
    assert 0.5 < pressed.gained_mm <= 1.0
    assert 0.5 < pressed.lost_mm <= 1.0
    assert raised.lost_mm == 0.0  # swallowed by the result
    assert 0.5 < raised.gained_mm <= 1.0


def test_what_was_taken_and_added_on_purpose_counts_as_area_alone() -> None:
    before = without_faces(cube(2.0), [0])
    crumb = cube(0.5, (10.0, 0.0, 0.0))
    both = Mesh.of(np.concatenate((before.vertices, crumb.vertices)), np.concatenate((before.faces, crumb.faces + 8)))
    after = cube(2.0)
    middle, nothing = np.zeros((1, 3)), np.zeros(1)
    taken = Change("small_pieces", "", middle, nothing, taken=crumb.triangles())
    added = Change("holes", "", middle, nothing, added=after.triangles()[:1])
    known = extent(both, after, taken, added)
    assert (known.lost_mm, known.gained_mm) == (0.0, 0.0)
    assert known.area_taken == pytest.approx(1.5 / (22.0 + 1.5))
    assert known.area_added == pytest.approx(2.0 / (22.0 + 1.5))
    assert extent(both, after, added).lost_mm == pytest.approx(8.5)


@pytest.mark.parametrize(("now", "change"), [(1.0, 0.0), (3.0, 0.0), (0.4, 0.2), (3.3, 0.1)])
def test_the_volume_may_lie_between_what_pieces_allow(now: float, change: float) -> None:
    mesh = cube(2.0)
    assert extent(mesh, mesh, volumes=(1.0, 3.0, now)).volume_change == pytest.approx(change)


def test_the_refusal_names_every_limit_that_is_broken() -> None:
    with pytest.raises(InputError) as refusal:
        require_within(Extent(0, 0.3, 0.1, 0.06, 7.0, 1.0), inputs())
    assert refusal.value.code == "heal.changes_too_much"
    assert refusal.value.facts["deviation_mm"] == 7.0
    for name in ("max_area_change", "max_volume_change", "max_deviation_mm"):
        assert name in refusal.value.message
    require_within(Extent(0, 0.25, 0.25, 0.05, 5.0, 5.0), inputs())


def test_the_volume_of_an_open_cube_is_that_of_the_closed_one() -> None:
    mesh = without_faces(cube(2.0), [4, 5])
    assert piece_volumes(mesh.vertices, mesh.faces) == pytest.approx([8.0])
