"""Surfaces of labels against the solids the labels were cut from."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from core.errors import InputError
from core.label_volume import LabelVolume
from core.mesh import Mesh
from core.schema.segment import SegmentParameters
from core.segmentation.segment import segment
from core.validation.validate import Validation, validate
from tests.core.segmentation.labelled_solids import affine_of, centred, from_ring, oblique, places, ring, side_by_side, spheres

GAP = 0.1
ALL = SegmentParameters()


def made(volume: LabelVolume, asked: SegmentParameters = ALL, gap: float = GAP) -> tuple[dict[str, Mesh], Validation]:
    """Surfaces, and what the referee says: no intersection at all, and the gap."""
    found = {name: each.mesh for name, each in segment(volume, asked, gap).items()}
    proof = validate(found, min_gap_mm=gap)
    assert proof.verdict == "simulation_ready", proof.findings
    return found, proof


def from_sphere(mesh: Mesh, radius: float) -> NDArray[np.float64]:
    """Distances of vertices and centres of faces to the sphere."""
    points = np.vstack((mesh.vertices, mesh.triangles().mean(axis=1)))
    distance: NDArray[np.float64] = np.linalg.norm(points, axis=1) - radius
    return distance


@pytest.mark.parametrize(
    ("sides", "turn", "volume_error"),
    [
        pytest.param((1, 1, 1), None, 0.01, id="even"),
        pytest.param((1, 1, 3), None, 0.02, id="thick slices"),
        pytest.param((1.2, 0.9, 1.6), oblique(), 0.01, id="oblique"),
        pytest.param((-1, 1, 1), None, 0.01, id="left-handed"),
    ],
)
def test_a_sphere_keeps_its_size_and_place(sides: tuple[float, ...], turn: object, volume_error: float) -> None:
    radius = 14.0
    found, proof = made(spheres((radius,), centred(radius, sides, turn)))  # type: ignore[arg-type]
    report = proof.meshes["label_1"]
    assert report.oriented_outward
    assert report.genus == 0
    assert report.volume_mm3 == pytest.approx(4 / 3 * math.pi * radius**3, rel=volume_error)
    distance = from_sphere(found["label_1"], radius)
    largest = max(abs(side) for side in sides)
    assert np.abs(distance).max() < 0.5 * largest
    assert np.sqrt((distance**2).mean()) < 0.13 * largest
    assert report.quality.minimum > 0.02
    assert report.quality.median > 0.75


def test_a_torus_keeps_its_hole() -> None:
    volume, _affine = ring(14.0, 5.0, 1.0)
    found, proof = made(volume)
    report = proof.meshes["label_5"]
    assert report.genus == 1
    assert report.volume_mm3 == pytest.approx(2 * math.pi**2 * 14.0 * 25.0, rel=0.02)
    assert np.abs(from_ring(found["label_5"].vertices, 14.0, 5.0)).max() < 0.5


def test_nested_labels_are_nested_surfaces() -> None:
    radii = (14.0, 11.5, 7.0)
    found, proof = made(spheres(radii, centred(14.0, (1, 1, 1))))
    assert proof.nesting == {"label_1": None, "label_2": "label_1", "label_3": "label_2"}
    for (name, mesh), radius in zip(found.items(), radii, strict=True):
        assert np.abs(from_sphere(mesh, radius)).max() < 0.5
        assert proof.meshes[name].components == 1


def test_a_sheet_that_is_open_across_edges_of_voxels_still_encloses() -> None:
    volume = spheres((12.0, 10.9), centred(12.0, (1, 1, 1)))
    found = segment(volume, ALL, GAP)
    proof = validate({name: each.mesh for name, each in found.items()}, min_gap_mm=GAP)
    assert proof.nesting == {"label_1": None, "label_2": "label_1"}
    assert [mesh.genus for mesh in proof.meshes.values()] == [0, 0]
    assert 0 < found["label_1"].sealed < 0.15 * found["label_1"].labelled


def test_with_cavities_kept_a_shell_has_two_borders_and_both_tissues_give_way() -> None:
    _found, proof = made(spheres((12.0, 8.0), centred(12.0, (1, 1, 1))), SegmentParameters(cavities="keep"))
    shell, core = proof.meshes["label_1"], proof.meshes["label_2"]
    assert (shell.components, core.components) == (2, 1)
    lost = GAP / 2 * 4 * math.pi * 8.0**2
    assert core.volume_mm3 == pytest.approx(4 / 3 * math.pi * 8.0**3 - lost, rel=0.02)


def test_labels_that_lie_side_by_side_are_nested_when_asked() -> None:
    asked = SegmentParameters(inside={"label_3": "label_2", "label_2": "label_1"})
    found = segment(side_by_side(), asked, GAP)
    proof = validate({name: each.mesh for name, each in found.items()}, min_gap_mm=GAP)
    assert proof.verdict == "simulation_ready", proof.findings
    assert proof.nesting == {"label_1": None, "label_2": "label_1", "label_3": "label_2"}
    assert [(mesh.genus, mesh.components) for mesh in proof.meshes.values()] == [(0, 1)] * 3
    whole = float((side_by_side().labels > 0).sum())
    assert proof.meshes["label_1"].volume_mm3 == pytest.approx(whole, rel=0.01)
    assert found["label_1"].sealed > 0
    without = validate({name: each.mesh for name, each in segment(side_by_side(), ALL, GAP).items()}, min_gap_mm=GAP)
    assert set(without.nesting.values()) == {None}  # beside each other, as the voxels are


def test_who_holds_whom_must_make_sense() -> None:
    with pytest.raises(InputError) as refused:
        segment(side_by_side(), SegmentParameters(inside={"brain": "label_1"}), GAP)
    assert refused.value.code == "segment.unknown_surface"
    for bad in ({"inside": {"a": "b", "b": "a"}}, {"inside": {"a": "b"}, "cavities": "keep"}):
        with pytest.raises(ValueError, match="inside"):
            SegmentParameters.model_validate(bad)


def quarters() -> LabelVolume:
    """A ball in four parts that meet in a line, and in a point with the air around."""
    affine = centred(10.0, (1, 1, 1))
    centres = places((26, 26, 26), affine)
    part = 1 + (centres[..., 0] > 0) + 2 * (centres[..., 1] > 0.3)
    return LabelVolume.of(np.where(np.linalg.norm(centres, axis=-1) <= 10.0, part, 0).astype(np.uint16), affine)


def test_neighbours_that_meet_in_lines_are_apart_and_fill_the_ball() -> None:
    found, proof = made(quarters())
    assert len(proof.pairs) == 6
    assert all(pair.relation == "disjoint" for pair in proof.pairs)
    assert min(pair.min_gap_mm or 0.0 for pair in proof.pairs) == pytest.approx(GAP, rel=0.05)
    whole = 4 / 3 * math.pi * 1000.0
    walls = 2 * math.pi * 100.0 * GAP  # two discs, a gap wide
    assert sum(proof.meshes[name].volume_mm3 or 0.0 for name in found) == pytest.approx(whole - walls, rel=0.02)


def test_noise_of_three_labels_is_still_sound() -> None:
    labels = np.random.default_rng(3).integers(0, 4, (8, 8, 8)).astype(np.uint16)
    for asked in (ALL, SegmentParameters(islands="keep_all", cavities="keep")):
        made(LabelVolume.of(labels, affine_of((1, 1, 1))), asked)


def dumbbell() -> LabelVolume:
    """Three boxes of label 2: 27, 8 and 1 voxels, apart; a box of label 3 that touches the border of the volume."""
    labels = np.zeros((14, 9, 9), dtype=np.uint16)
    labels[1:4, 1:4, 1:4] = labels[6:8, 1:3, 1:3] = labels[10, 2, 2] = 2
    labels[6:, 5:8, 5:8] = 3
    return LabelVolume.of(labels, affine_of((2, 2, 2)))


@pytest.mark.parametrize(
    ("asked", "pieces", "dropped"),
    [
        (SegmentParameters(), 1, 9),
        (SegmentParameters(islands="keep_above", min_island_mm3=60.0), 2, 1),
        (SegmentParameters(islands="keep_all"), 3, 0),
    ],
)
def test_islands_go_as_asked(asked: SegmentParameters, pieces: int, dropped: int) -> None:
    found = segment(dumbbell(), asked, GAP)
    proof = validate({name: each.mesh for name, each in found.items()}, min_gap_mm=GAP)
    assert proof.meshes["label_2"].components == pieces
    assert found["label_2"].dropped == dropped
    assert (found["label_2"].at_border, found["label_3"].at_border) == (0, 9)
    assert proof.meshes["label_3"].closed


def test_names_choose_and_join_labels() -> None:
    assert list(segment(quarters(), SegmentParameters(names={"1": "left", "3": "left", "2": "right"}), GAP)) == ["left", "right"]
    several = SegmentParameters(names={"2": "right"}, others="include")
    assert list(segment(quarters(), several, GAP)) == ["label_1", "right", "label_3", "label_4"]


def test_without_thinning_or_smoothing_the_first_surface_comes() -> None:
    plain = SegmentParameters(smoothing=0, faces_share=1.0)
    found, _proof = made(spheres((6.0,), centred(6.0, (1, 1, 1))), plain)
    thinned, _proof = made(spheres((6.0,), centred(6.0, (1, 1, 1))))
    assert len(thinned["label_1"].faces) == pytest.approx(0.33 * len(found["label_1"].faces), rel=0.02)


def test_the_same_volume_gives_the_same_bytes() -> None:
    first, second = (segment(quarters(), ALL, GAP) for _ in range(2))
    assert all(np.array_equal(first[name].mesh.vertices, second[name].mesh.vertices) for name in first)
    assert all(np.array_equal(first[name].mesh.faces, second[name].mesh.faces) for name in first)


@pytest.mark.parametrize(
    ("asked", "gap", "code"),
    [
        (SegmentParameters(names={"9": "nothing"}), GAP, "segment.label_missing"),
        (ALL, 0.6, "segment.gap_too_wide"),
        (SegmentParameters(islands="keep_above", min_island_mm3=1e4), GAP, "segment.nothing_left"),
    ],
)
def test_what_cannot_be_is_refused(asked: SegmentParameters, gap: float, code: str) -> None:
    with pytest.raises(InputError) as error:
        segment(dumbbell(), asked, gap)
    assert error.value.code == code


def test_too_many_labels_are_refused() -> None:
    labels = np.arange(5**3, dtype=np.uint16).reshape(5, 5, 5)
    with pytest.raises(InputError) as error:
        segment(LabelVolume.of(labels, affine_of((1, 1, 1))), ALL, GAP)
    assert error.value.code == "segment.too_many_surfaces"
