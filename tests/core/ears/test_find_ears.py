"""The real body's ears in every axis convention and size; what has none."""

import manifold3d
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.ears.find_ears import MARGIN_MM, Ear, find_ears
from core.errors import InputError
from core.geometry.body_frame import find_body_frame
from core.mesh import Mesh
from subjects.body import body
from tests.core.ears.turns import TURNS
from tests.solids import cube, sphere, torus

# measured by hand on pictures of the body (y up, z to the front, x to its left): helix to lobe, back of the helix to the tragus
LEFT_PINNA_LOW, LEFT_PINNA_HIGH = np.array([70.0, 684.0, 35.0]), np.array([87.5, 734.5, 60.0])


def part_of_body(low: float, high: float) -> Mesh:
    """The body between two heights, cut flat and closed."""
    skin = body(0)
    solid = manifold3d.Manifold(manifold3d.Mesh64(np.array(skin.vertices), skin.faces.astype(np.uint64)))
    part = solid.trim_by_plane((0, 1, 0), low).trim_by_plane((0, -1, 0), -high).to_mesh64()
    return Mesh.of(part.vert_properties[:, :3], part.tri_verts.astype(np.int64))


def boxes(ears: tuple[Ear, Ear]) -> np.ndarray:
    return np.array([[ear.low, ear.high] for ear in ears])


@pytest.mark.parametrize("subdivisions", [0, 1])
def test_boxes_hold_the_pinnae_and_little_else(subdivisions):
    left, right = find_ears(body(subdivisions))
    assert (left.name, right.name) == ("left_ear", "right_ear")
    assert (left.low <= LEFT_PINNA_LOW).all()
    assert (left.high >= LEFT_PINNA_HIGH).all()
    assert np.abs(left.low - LEFT_PINNA_LOW).max() < 3 * MARGIN_MM
    assert np.abs(left.high - LEFT_PINNA_HIGH).max() < 3 * MARGIN_MM
    mirror = np.array([-1.0, 1.0, 1.0])
    np.testing.assert_allclose([right.high * mirror, right.low * mirror][0][1:], left.high[1:], atol=1e-3)
    np.testing.assert_allclose([-right.high[0], -right.low[0]], [left.low[0], left.high[0]], atol=1e-3)
    assert left.outward.tolist() == [1, 0, 0]
    assert right.outward.tolist() == [-1, 0, 0]


@pytest.mark.parametrize("turn", TURNS, ids=str)
def test_standing_or_lying_in_any_convention(turn):
    skin, at = body(0), np.array([30.0, -200.0, 900.0])
    found = boxes(find_ears(skin.with_vertices(skin.vertices @ turn.T + at)))
    expected = boxes(find_ears(skin)) @ turn.T + at
    np.testing.assert_allclose(found.min(axis=1), expected.min(axis=1), atol=0.1)
    np.testing.assert_allclose(found.max(axis=1), expected.max(axis=1), atol=0.1)


@pytest.mark.parametrize("degrees", [-5.0, 5.0])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_who_leans_a_little_keeps_both_ears(axis, degrees):
    skin, turn = body(0), Rotation.from_euler(axis, degrees, degrees=True)
    leaning = skin.with_vertices(turn.apply(skin.vertices.copy()))
    for straight, found in zip(find_ears(skin), find_ears(leaning), strict=True):
        assert found.name == straight.name
        pinna = leaning.vertices[straight.holds(skin.vertices)]
        assert found.holds(pinna).mean() > 0.95


@pytest.mark.parametrize("scale", [0.8, 0.9, 1.1, 1.2])
def test_small_and_tall_people(scale):
    skin = body(0)
    found = boxes(find_ears(skin.with_vertices(scale * skin.vertices)))
    bare = boxes(find_ears(skin)) + np.array([MARGIN_MM, -MARGIN_MM])[:, None]
    np.testing.assert_allclose(found + np.array([MARGIN_MM, -MARGIN_MM])[:, None], scale * bare, atol=0.1)


CASES = {
    "sphere": (sphere(500.0, 4), "stand or lie like a person"),
    "cube": (cube(900.0), "stand or lie like a person"),
    "torus": (torus(400.0, 100.0, 40, 20), "stand or lie like a person"),
    "torso": (part_of_body(100.0, 560.0), "stand or lie like a person"),
    "headless": (part_of_body(-900.0, 560.0), "no head"),
    "with a neck": (part_of_body(-900.0, 600.0), "no two ears"),
    "cut below the ears": (part_of_body(-900.0, 670.0), "no two ears"),
}


@pytest.mark.parametrize(("mesh", "words"), CASES.values(), ids=CASES)
def test_what_has_no_ears_is_refused_by_name(mesh, words):
    with pytest.raises(InputError, match=words) as caught:
        find_ears(mesh)
    assert caught.value.code == "ears.not_found"


def without_ears(sides: tuple[int, ...]) -> Mesh:
    """Pinnae flattened into the side of the head."""
    skin = body(0)
    vertices = skin.vertices.copy()
    for side, ear in zip((1, -1), find_ears(skin), strict=True):
        if side in sides:
            inside = ear.holds(vertices)
            vertices[inside, 0] = side * np.minimum(side * vertices[inside, 0], 66.0 + 0.002 * side * vertices[inside, 0])
    return skin.with_vertices(vertices)


@pytest.mark.parametrize("scale", [1.0, 1.2])
@pytest.mark.parametrize("sides", [(1,), (-1,), (1, -1)], ids=str)
def test_a_missing_ear_is_noticed(sides, scale):
    mesh = without_ears(sides).with_vertices(scale * without_ears(sides).vertices)
    assert find_body_frame(mesh).is_person
    with pytest.raises(InputError) as caught:
        find_ears(mesh)
    assert caught.value.code == "ears.not_found"
