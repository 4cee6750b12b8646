"""Layers around the skin: the same promises as below it, seen from the other side."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from core.errors import InputError
from core.geometry.quality import quality
from core.shells.nested_shells import create_shells
from core.shells.sheet import Sheet
from core.shells.thickness import measure_thickness
from core.shells.thinnest_stack import _no_room
from subjects.body import body
from subjects.corpus import foot, hand
from subjects.generated.solid import bowl, gear, near_touching_fingers
from tests.core.shells.solids import cube, sphere, torus
from tests.core.shells.test_nested_shells import prove, wanted

GEL = {"name": "gel", "depth_mm": 2.0, "side": "outside"}
HAIR = {"name": "hair", "depth_mm": 0.5, "side": "outside"}
FAT = {"name": "fat", "depth_mm": 1.0}


def test_sphere_gives_larger_and_smaller_spheres_in_the_order_asked_for():
    skin = sphere(20.0)
    shells = create_shells(skin, wanted(GEL, HAIR, FAT))
    prove(skin, shells, 0.05)
    assert [(shell.name, shell.side) for shell in shells] == [("gel", "outside"), ("hair", "outside"), ("fat", "inside")]
    for shell, offset in zip(shells, (2.0, 0.5, -1.0), strict=True):
        assert np.linalg.norm(shell.mesh.vertices, axis=1) == pytest.approx(20.0 + offset, abs=0.06)


def test_torus_gives_a_thicker_torus_until_its_hole_is_full():
    skin = torus(30.0, 8.0)
    (gel,) = create_shells(skin, wanted(GEL))
    prove(skin, (gel,), 0.05)
    x, y, z = gel.mesh.vertices.T
    assert np.hypot(np.hypot(x, y) - 30.0, z) == pytest.approx(10.0, abs=0.08)

    skin = torus(10.0, 8.0)  # the hole leaves 2 mm to its middle
    (gel,) = create_shells(skin, wanted(GEL | {"depth_mm": 4.0}))
    prove(skin, (gel,), 0.05)
    thickness = measure_thickness(gel, 4.0)
    assert thickness.side == "outside"
    assert thickness.limited_area > 0.03
    assert thickness.missed_area < 0.07
    x, y, _z = gel.mesh.vertices.T
    assert np.hypot(x, y).min() > 0.0  # the hole is still there


def test_cube_is_wrapped_at_one_distance_so_its_edges_turn_round():
    skin = cube(60.0, cuts=3)
    (gel,) = create_shells(skin, wanted(GEL))
    prove(skin, (gel,), 0.05)
    beyond = np.maximum(np.abs(gel.mesh.vertices) - 30.0, 0.0)
    assert np.linalg.norm(beyond, axis=1) == pytest.approx(2.0, abs=1e-3)


def test_fingers_that_nearly_touch_get_a_layer_that_thins_out_between_them():
    skin = near_touching_fingers(7, 1.0, 1.5)
    shells = create_shells(skin, wanted(HAIR | {"depth_mm": 1.0}, FAT))
    prove(skin, shells, 0.05)
    hair = shells[0]
    assert hair.depth_mm.max() == pytest.approx(1.0, abs=0.15)
    assert measure_thickness(hair, 1.0).limited_area > 0.01


def test_body_is_wrapped_and_filled_at_once():
    skin = body(0)
    shells = create_shells(skin, wanted(GEL, FAT))
    prove(skin, shells, 0.05)
    gel, fat = shells
    assert measure_thickness(gel, 2.0).on_target_area >= 0.985
    assert measure_thickness(fat, 1.0).on_target_area >= 0.985
    # layers on one side do not know of those on the other
    (alone,) = create_shells(skin, wanted(FAT))
    assert np.array_equal(alone.mesh.vertices, fat.mesh.vertices)


@pytest.mark.parametrize("make", [hand, foot, lambda: gear(25, 12, 12, 1.5), lambda: bowl(30, 3, 64)])
def test_two_layers_around_what_is_hard_are_proven(make):
    skin = make()
    shells = create_shells(skin, wanted(GEL | {"depth_mm": 3.0}, HAIR | {"depth_mm": 1.0}))
    prove(skin, shells, 0.05)
    assert min(measure_thickness(shell, 1.0).on_target_area for shell in shells) > 0.75


def test_slits_without_room_for_the_gap_are_refused_with_places():
    with pytest.raises(InputError) as refused:
        create_shells(near_touching_fingers(7, 0.02, 1.5), wanted(HAIR))
    assert refused.value.code == "shells.no_room"
    assert refused.value.findings[0].places
    assert "`smooth` the skin, whose lowest quality is 0.00045" in str(refused.value)


@pytest.mark.parametrize(("flatness", "advised"), [(1.0, False), (0.2, True)])
def test_a_refusal_advises_smoothing_where_triangles_are_poor(flatness, advised):
    """Of a body with arms set apart the lowest quality was 0.06: no slivers, and smoothing made room all the same."""
    ball = sphere(20.0)
    skin = ball.with_vertices(ball.vertices * (1.0, 1.0, flatness))
    refusal = _no_room(skin, Sheet.copy_of(skin.vertices, skin.faces), np.array([0]), "fat", 0.05)
    assert quality(skin.vertices, skin.faces).min() > 0.05
    assert ("`smooth` the skin" in refusal.message) == advised


def test_region_has_its_own_distance_outside_too():
    skin = sphere(40.0)
    region = {"name": "pad", "box_mm": {"min": [30, -20, -20], "max": [50, 20, 20]}, "depths_mm": {"gel": 5.0}}
    (gel,) = create_shells(skin, wanted(GEL, regions=[region]))
    prove(skin, (gel,), 0.05)
    inside = (skin.vertices[:, 0] > 31) & (np.abs(skin.vertices[:, 1:]) < 19).all(axis=1)
    assert gel.depth_mm[inside] == pytest.approx(5.0, rel=0.05)
    assert gel.depth_mm[skin.vertices[:, 0] < 10] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(
    ("layers", "words"),
    [
        ((FAT, GEL), "those outside the skin first"),
        ((HAIR, GEL), "outside the skin decrease"),
        ((GEL | {"side": "above"},), "inside"),
        ((GEL | {"depth_mm": -2.0},), "greater than 0"),
        ((GEL | {"depth_array": "gel_mm"},), "either depth_mm or depth_array"),
        (({"name": "fat"},), "either depth_mm or depth_array"),
        (({"name": "fat", "depth_array": "../fat"},), "pattern"),
    ],
)
def test_what_makes_no_sense_is_refused(layers, words):
    with pytest.raises(ValidationError, match=words):
        wanted(*layers)


def test_region_that_turns_the_order_round_is_refused():
    region = {"name": "pad", "box_mm": {"min": [0, 0, 0], "max": [1, 1, 1]}, "depths_mm": {"gel": 0.4}}
    with pytest.raises(ValidationError, match="region 'pad'"):
        wanted(GEL, HAIR, regions=[region])
