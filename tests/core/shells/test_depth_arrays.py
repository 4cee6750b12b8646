"""Depths that come with the skin, one per vertex."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.shells.nested_shells import create_shells
from core.shells.thickness import measure_thickness
from tests.core.shells.solids import sphere
from tests.core.shells.test_nested_shells import prove, wanted

SKIN = sphere(40.0)
FAT = {"name": "fat", "depth_array": "fat_depth_mm"}
BODY = {"name": "average_body", "depth_mm": 6.0}
SLOPE = 1.0 + (SKIN.vertices[:, 2] + 40.0) / 40.0  # 1 mm at the bottom, 3 mm at the top


def make(*layers, arrays=None, **more):
    return create_shells(SKIN, wanted(*layers, **more), arrays={"fat_depth_mm": SLOPE} if arrays is None else arrays)


def test_the_layer_follows_the_depth_of_each_vertex():
    shells = make(FAT, BODY)
    prove(SKIN, shells, 0.05)
    fat, average_body = shells
    assert len(fat.mesh.vertices) == len(SKIN.vertices)
    assert fat.depth_mm == pytest.approx(SLOPE, rel=0.05)
    assert average_body.depth_mm == pytest.approx(6.0, rel=0.05)
    thickness = measure_thickness(fat, None, "fat_depth_mm")
    assert thickness.target_array == "fat_depth_mm"
    assert thickness.target_mm == pytest.approx(2.0, abs=0.05)
    assert thickness.on_target_area == 1.0


def test_a_constant_array_is_a_constant_depth():
    by_array = make(FAT, BODY, arrays={"fat_depth_mm": np.full(len(SKIN.vertices), 1.5)})
    by_number = make({"name": "fat", "depth_mm": 1.5}, BODY)
    for one, other in zip(by_array, by_number, strict=True):
        assert np.array_equal(one.mesh.vertices, other.mesh.vertices)


def test_regions_blend_over_an_array_as_over_a_number():
    region = {
        "name": "ear",
        "box_mm": {"min": [30, -20, -20], "max": [50, 20, 20]},
        "depths_mm": {"fat": 0.3},
        "blend_mm": 5.0,
    }
    fat, _body = make(FAT, BODY, regions=[region])
    inside = (SKIN.vertices[:, 0] > 31) & (np.abs(SKIN.vertices[:, 1:]) < 19).all(axis=1)
    far = SKIN.vertices[:, 0] < 10
    assert fat.depth_mm[inside] == pytest.approx(0.3, rel=0.05)
    assert fat.depth_mm[far] == pytest.approx(SLOPE[far], rel=0.05)


def test_layers_outside_take_arrays_too():
    (gel,) = make(FAT | {"name": "gel", "side": "outside"})
    prove(SKIN, (gel,), 0.05)
    assert gel.depth_mm == pytest.approx(SLOPE, rel=0.05)


def test_an_array_that_is_not_there_is_refused_with_those_that_are():
    with pytest.raises(InputError) as refused:
        make(FAT, arrays={"fat_mm": SLOPE, "age": SLOPE})
    assert refused.value.code == "layer.array_missing"
    assert "age, fat_mm" in refused.value.message


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 0.0, -1.0, 100.1, 1e300])
def test_values_that_are_no_depths_are_refused_with_their_vertices(value):
    depths = SLOPE.copy()
    depths[[7, 9]] = value
    with pytest.raises(InputError) as refused:
        make(FAT, arrays={"fat_depth_mm": depths})
    assert refused.value.code == "layer.array_out_of_range"
    (finding,) = refused.value.findings
    assert finding.count == 2
    assert [place.vertices for place in finding.places] == [(7,), (9,)]


def test_layers_that_pass_each_other_at_a_vertex_are_refused():
    depths = SLOPE.copy()
    depths[11] = 6.0
    with pytest.raises(InputError) as refused:
        make(FAT, BODY, arrays={"fat_depth_mm": depths})
    assert refused.value.code == "layer.depths_out_of_order"
    assert refused.value.findings[0].places[0].vertices == (11,)
    assert "'average_body' does not lie inside layer 'fat' at 1 of" in refused.value.message


def test_layers_that_pass_each_other_only_inside_a_region_are_refused():
    region = {"name": "ear", "box_mm": {"min": [30, -20, -20], "max": [50, 20, 20]}, "depths_mm": {"average_body": 1.2}}
    with pytest.raises(InputError) as refused:
        make(FAT, BODY, regions=[region])
    assert refused.value.code == "layer.depths_out_of_order"
