"""Shells against closed forms, on a body, and where there is no room."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from core.errors import InputError
from core.geometry.distance import smallest_gap
from core.mesh import Mesh
from core.schema.shells import ShellsInputs
from core.shells.nested_shells import Shell, create_shells
from core.shells.thickness import measure_thickness
from core.validation.measure import measure_surface
from core.validation.surface import Surface
from core.validation.validate import validate
from subjects.body import body
from tests.core.shells.solids import capsule, cube, plate, sphere, torus

SKIN = {"href": "/v1/meshes/00000000-0000-0000-0000-000000000000"}
THESIS = ({"name": "fat", "depth_mm": 1.0}, {"name": "average_body", "depth_mm": 3.0})


def wanted(*layers, **more) -> ShellsInputs:
    return ShellsInputs.model_validate({"skin": SKIN, "layers": layers or THESIS, **more})


def prove(skin: Mesh, shells: tuple[Shell, ...], min_gap_mm: float) -> None:
    """Everything the process promises, by the exact referee."""
    around = {shell.name: shell.mesh for shell in shells if shell.side == "outside"}
    surfaces = {**around, "skin": skin, **{shell.name: shell.mesh for shell in shells if shell.name not in around}}
    proof = validate(surfaces, min_gap_mm=min_gap_mm)
    assert [f.message for f in proof.findings if f.severity == "error"] == []
    assert list(proof.nesting.values()) == [None, *list(surfaces)[:-1]]
    for outer, inner in pairwise(surfaces.values()):
        assert smallest_gap(outer, inner)[0] >= min_gap_mm
    for mesh in surfaces.values():
        assert np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32))


def test_sphere_gives_smaller_spheres():
    skin = sphere(20.0)
    shells = create_shells(skin, wanted())
    prove(skin, shells, 0.05)
    for shell, depth in zip(shells, (1.0, 3.0), strict=True):
        radii = np.linalg.norm(shell.mesh.vertices, axis=1)
        # the faceted sphere lies up to its sagitta inside the round one
        assert radii == pytest.approx(20.0 - depth, abs=0.06)


def test_torus_gives_thinner_tori():
    skin = torus(30.0, 8.0)
    shells = create_shells(skin, wanted())
    prove(skin, shells, 0.05)
    for shell, depth in zip(shells, (1.0, 3.0), strict=True):
        x, y, z = shell.mesh.vertices.T
        minor = np.hypot(np.hypot(x, y) - 30.0, z)
        assert minor == pytest.approx(8.0 - depth, abs=0.08)


def test_capsule_gives_thinner_capsules():
    skin = capsule(10.0, 40.0)
    axis_low, axis_high = skin.vertices[:, 2].min() + 10.0, skin.vertices[:, 2].max() - 10.0
    shells = create_shells(skin, wanted())
    prove(skin, shells, 0.05)
    for shell, depth in zip(shells, (1.0, 3.0), strict=True):
        points = shell.mesh.vertices
        nearest_on_axis = np.clip(points[:, 2], axis_low, axis_high)
        radii = np.sqrt(points[:, 0] ** 2 + points[:, 1] ** 2 + (points[:, 2] - nearest_on_axis) ** 2)
        assert radii == pytest.approx(10.0 - depth, abs=0.08)


def test_cube_gives_exact_cubes():
    skin = cube(60.0)
    shells = create_shells(skin, wanted())
    prove(skin, shells, 0.05)
    for shell, depth in zip(shells, (1.0, 3.0), strict=True):
        assert np.abs(shell.mesh.vertices) == pytest.approx(30.0 - depth, abs=1e-3)


def test_cube_with_fine_faces_keeps_its_promise_at_edges_sharper_than_any_reach():
    skin = cube(60.0, cuts=4)
    shells = create_shells(skin, wanted())
    prove(skin, shells, 0.05)
    assert measure_thickness(shells[0], 1.0).on_target_area > 0.85


def test_plate_thinner_than_the_deepest_layer_thins_out_instead_of_breaking():
    skin = plate(40.0, 2.0)
    shells = create_shells(skin, wanted({"name": "fat", "depth_mm": 0.5}, {"name": "average_body", "depth_mm": 0.8}))
    prove(skin, shells, 0.05)
    with pytest.raises(InputError) as refused:
        create_shells(skin, wanted())
    assert refused.value.code == "layer.deeper_than_reach"
    assert refused.value.facts["deepest_mm"] < 1.5
    assert all(place.faces for place in refused.value.findings[0].places)


def test_six_layers_on_a_sphere():
    depths = (0.3, 0.6, 1.0, 2.0, 3.0, 5.0)
    skin = sphere(20.0)
    shells = create_shells(skin, wanted(*({"name": f"layer_{i}", "depth_mm": d} for i, d in enumerate(depths))))
    prove(skin, shells, 0.05)
    for shell, depth in zip(shells, depths, strict=True):
        assert np.linalg.norm(shell.mesh.vertices, axis=1) == pytest.approx(20.0 - depth, abs=0.06)


def test_body_meets_the_numbers_of_the_thesis_case():
    skin = body(0)
    shells = create_shells(skin, wanted())
    prove(skin, shells, 0.05)
    fat, average_body = (measure_thickness(s, t) for s, t in zip(shells, (1.0, 3.0), strict=True))
    assert fat.on_target_area >= 0.985
    assert average_body.on_target_area >= 0.98
    assert fat.missed_area <= 0.01
    assert average_body.missed_area <= 0.01
    for report in (measure_surface(Surface(shell.name, shell.mesh)) for shell in shells):
        assert report.quality.minimum >= 0.05
        assert report.quality.percentile_1 >= 0.2
        assert report.minimum_dihedral_deg is not None
        assert report.minimum_dihedral_deg >= 5.0


@pytest.mark.slow
def test_six_layers_of_a_coarse_body_are_well_shaped_and_on_target():
    depths = (0.3, 0.6, 1.0, 2.0, 3.0, 5.0)
    shells = create_shells(body(0), wanted(*({"name": f"layer_{i}", "depth_mm": d} for i, d in enumerate(depths))))
    prove(body(0), shells, 0.05)
    for shell, depth in zip(shells, depths, strict=True):
        report = measure_surface(Surface(shell.name, shell.mesh))
        assert report.quality.minimum >= 0.015
        assert report.quality.percentile_1 >= 0.2
        assert measure_thickness(shell, depth).on_target_area >= 0.98


def test_equal_input_gives_equal_bytes():
    first, second = (create_shells(body(0), wanted()) for _ in range(2))
    assert all(np.array_equal(a.mesh.vertices, b.mesh.vertices) for a, b in zip(first, second, strict=True))


def test_region_has_its_own_depths_and_blends_out():
    skin = sphere(40.0, 5)
    region = {
        "name": "ear",
        "box_mm": {"min": [30, -20, -20], "max": [50, 20, 20]},
        "depths_mm": {"fat": 0.3, "average_body": 0.6},
        "blend_mm": 5.0,
    }
    shells = create_shells(skin, wanted(regions=[region]))
    prove(skin, shells, 0.05)
    inside = (skin.vertices[:, 0] > 31) & (np.abs(skin.vertices[:, 1:]) < 19).all(axis=1)
    outside = skin.vertices[:, 0] < 10
    assert shells[0].depth_mm[inside] == pytest.approx(0.3, rel=0.05)
    assert shells[1].depth_mm[inside] == pytest.approx(0.6, rel=0.05)
    assert shells[0].depth_mm[outside] == pytest.approx(1.0, rel=0.05)
    assert shells[1].depth_mm[outside] == pytest.approx(3.0, rel=0.05)
    blend = ~inside & ~outside
    assert len(np.unique(np.round(shells[1].targets_mm[blend], 2))) > 20  # a slope, not a step


def test_region_off_the_skin_is_refused_with_the_extents():
    region = {"name": "ear", "box_mm": {"min": [100, 0, 0], "max": [110, 1, 1]}, "depths_mm": {"fat": 0.3}}
    with pytest.raises(InputError) as refused:
        create_shells(sphere(20.0, 3), wanted(regions=[region]))
    assert refused.value.code == "region.outside_mesh"
    assert "-20" in refused.value.message


def test_overlapping_regions_must_agree():
    box = {"min": [10, -5, -5], "max": [25, 5, 5]}
    regions = [{"name": n, "box_mm": box, "depths_mm": {"fat": d}} for n, d in (("a", 0.3), ("b", 0.4))]
    with pytest.raises(InputError) as refused:
        create_shells(sphere(20.0, 3), wanted(regions=regions))
    assert refused.value.code == "region.overlap_conflict"


def test_layer_deeper_than_any_reach_is_refused_with_the_deepest():
    with pytest.raises(InputError) as refused:
        create_shells(sphere(20.0, 3), wanted({"name": "core", "depth_mm": 60.0}))
    assert refused.value.code == "layer.deeper_than_reach"
    assert 15 < refused.value.facts["deepest_mm"] < 20


def test_policy_fail_refuses_thin_anatomy_with_places():
    with pytest.raises(InputError) as refused:
        create_shells(body(0), wanted(thin_policy="fail"))
    assert refused.value.code == "skin.too_thin"
    (finding,) = refused.value.findings
    assert finding.count > 100
    assert len(finding.places) == 100


def test_gap_that_does_not_fit_is_refused_with_places():
    with pytest.raises(InputError) as refused:
        create_shells(body(0), wanted(min_gap_mm=2.0))
    assert refused.value.code == "shells.no_room"
    assert refused.value.findings[0].places
