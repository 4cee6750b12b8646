"""The real body in every axis convention; shapes that are no person."""

from itertools import permutations, product

import numpy as np
import pytest

from core.geometry.body_frame import find_body_frame
from core.geometry.section import cut
from core.reports.figures.levels import axis_name, find_levels
from subjects.body import body
from tests.solids import cube, sphere, tetrahedron, together

TURNS = [
    np.eye(3)[list(order)] * np.array(signs)[:, None]
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
    if np.linalg.det(np.eye(3)[list(order)] * np.array(signs)[:, None]) > 0
]


@pytest.mark.parametrize("turn", TURNS, ids=lambda turn: "".join(axis_name(row) for row in turn))
def test_a_person_is_recognised_in_any_convention(turn):
    skin = body(0)
    frame = find_body_frame(skin.with_vertices(skin.vertices @ turn.T + (10.0, -20.0, 500.0)))
    assert frame.is_person
    # the file has y up, z to the front, x to the left side of the body, which is the right of who faces it
    np.testing.assert_array_equal(frame.up, turn @ [0, 1, 0])
    np.testing.assert_array_equal(frame.front, turn @ [0, 0, 1])
    np.testing.assert_array_equal(frame.right, turn @ [1, 0, 0])


@pytest.mark.parametrize(
    "mesh",
    [sphere(500.0), cube(900.0), tetrahedron(700.0), together(*(sphere(100.0, at=(0, 0, 250 * i)) for i in range(5)))],
    ids=["sphere", "cube", "tetrahedron", "snowman"],
)
def test_no_person_no_claim(mesh):
    frame = find_body_frame(mesh)
    assert not frame.is_person
    assert list(find_levels(mesh, frame)) == ["sections"]


def test_height_is_the_longest_axis_and_z_if_all_are_alike():
    slab = cube(1.0).with_vertices(cube(1.0).vertices * (300.0, 100.0, 50.0))
    assert find_body_frame(slab).up.tolist() == [1, 0, 0]
    assert find_body_frame(sphere()).up.tolist() == [0, 0, 1]


def test_a_person_is_cut_at_ears_midline_torso_fingers_and_toes():
    skin = body(0)
    frame = find_body_frame(skin)
    levels = find_levels(skin, frame)
    ears, midline = levels["sections_head"]
    torso, fingers, toes = levels["sections_body"]
    assert ears.title == "Head at the ears, y = 724 mm"
    widest = np.abs(np.concatenate([contour.points for contour in cut(skin, ears.plane)])[:, 0]).max()
    assert 80 < widest < 95  # between the ears of an adult: 160 to 190 mm
    assert midline.title.endswith("x = 0 mm")
    assert len(cut(skin, torso.plane)) == 3  # trunk and two arms
    seen = [contour for contour in cut(skin, fingers.plane) if (contour.points >= fingers.low).all()]
    assert 3 <= len([contour for contour in seen if (contour.points <= fingers.high).all()]) <= 5
    in_window = [contour for contour in cut(skin, toes.plane) if (contour.points > toes.low).all()]
    assert len([contour for contour in in_window if (contour.points < toes.high).all()]) >= 3


def test_arms_at_the_sides_show_hands_beside_thighs():
    skin = body(0)
    # squeezed sideways: as narrow as somebody standing at attention
    narrow = skin.with_vertices(skin.vertices * (0.5, 1.0, 1.0))
    assert find_levels(narrow, find_body_frame(narrow))["sections_body"][1].title.startswith("Hands and thighs")
