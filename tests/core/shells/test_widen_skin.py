"""Moving the skin outwards where the body is too thin: as far as needed, never beyond the bound, nowhere else."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pydantic import ValidationError

from core.ears.find_ears import find_ears
from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from core.schema.shells import ShellsInputs
from core.shells.moved_places import describe_move
from core.shells.nested_shells import REACH_SHARE, Shell, create_shells
from core.shells.thickness import is_limited, vertex_areas
from core.shells.widen_skin import WidenedSkin, widen_skin
from core.validation.requirements import require_fit_skin
from subjects.body import body
from subjects.corpus import foot, hand
from subjects.generated.solid import gear, near_touching_fingers
from tests.core.shells.solids import plate, sphere
from tests.core.shells.test_nested_shells import prove, wanted

DEEP = ({"name": "fat", "depth_mm": 0.5}, {"name": "deep", "depth_mm": 1.0})


def widen(skin: Mesh, inputs: ShellsInputs) -> WidenedSkin:
    widened = widen_skin(skin, inputs)
    moved = np.linalg.norm(widened.mesh.vertices - skin.vertices, axis=1)
    assert np.array_equal(widened.moved_mm, moved)
    assert moved.max() <= inputs.skin_shift_mm
    assert np.array_equal(widened.mesh.vertices, widened.mesh.vertices.astype(np.float32))
    assert np.array_equal(widened.mesh.faces, skin.faces)
    require_fit_skin(widened.mesh, "skin")
    assert len(find_intersecting_faces(widened.mesh.vertices, widened.mesh.faces)) == 0
    return widened


def middle_of(mesh: Mesh) -> np.ndarray:
    """Vertices away from the rim of the plate."""
    return (np.abs(mesh.vertices[:, :2]) < 14.0).all(axis=1)


def test_a_plate_gets_as_thick_as_the_deepest_layer_needs() -> None:
    thin = plate(40.0, 2.0)
    inputs = wanted(*DEEP, skin_shift_mm=0.5)
    widened = widen(thin, inputs)
    middle = middle_of(thin)
    # half its thickness is the reach, of which the layers may use a share
    assert np.abs(widened.mesh.vertices[middle, 2]) == pytest.approx(1.0 / REACH_SHARE, abs=1e-3)
    shells = create_shells(widened.mesh, inputs)
    prove(widened.mesh, shells, 0.05)
    deep = shells[1].depth_mm[middle_of(shells[1].mesh)]
    assert np.percentile(deep, 5) == pytest.approx(1.0, rel=0.05)


def test_a_plate_too_thin_for_the_bound_is_moved_by_the_bound_and_no_further() -> None:
    thin = plate(40.0, 2.0)
    widened = widen(thin, wanted(*DEEP, skin_shift_mm=0.05))
    assert widened.moved_mm[middle_of(thin)] == pytest.approx(0.05, abs=1e-5)


def test_what_is_thick_enough_keeps_its_bits() -> None:
    skin = sphere(20.0)
    widened = widen(skin, wanted(skin_shift_mm=5.0))
    assert np.array_equal(widened.mesh.vertices, skin.vertices)
    assert describe_move(widened, 5.0) == ((), ())


def test_nothing_moves_by_default_and_nothing_for_layers_outside() -> None:
    thin = plate(40.0, 2.0)
    outside = {"name": "gel", "depth_mm": 3.0, "side": "outside"}
    for inputs in (wanted(*DEEP), wanted(outside, skin_shift_mm=5.0)):
        assert widen_skin(thin, inputs).mesh is thin


def test_fingers_that_nearly_touch_are_kept_apart() -> None:
    skin = near_touching_fingers(2, 0.2, 1.0)
    widened = widen(skin, wanted(skin_shift_mm=5.0))
    assert widened.moved_mm.max() > 0.5


@pytest.mark.parametrize("make", [hand, foot, lambda: gear(25, 12, 12, 1.5)])
def test_what_is_hard_stays_fit_and_can_be_filled(make: Callable[[], Mesh]) -> None:
    skin = make()
    inputs = wanted(skin_shift_mm=2.0)
    widened = widen(skin, inputs)
    assert widened.moved_mm.max() > 0.2
    prove(widened.mesh, create_shells(widened.mesh, inputs), 0.05)


def limited_area(shells: tuple[Shell, ...], low: np.ndarray, high: np.ndarray) -> float:
    """mm² of all layers within a box that the anatomy keeps off target."""
    total = 0.0
    for shell in shells:
        inside = ((shell.mesh.vertices >= low) & (shell.mesh.vertices <= high)).all(axis=1)
        total += float(vertex_areas(shell.mesh)[inside & is_limited(shell)].sum())
    return total


def test_less_of_the_bodys_ears_is_limited_the_further_the_skin_may_move() -> None:
    skin = body(0)
    ears = find_ears(skin)
    limited = []
    for bound in (0.0, 3.0):
        inputs = wanted(skin_shift_mm=bound)
        widened = widen(skin, inputs)
        shells = create_shells(widened.mesh, inputs)
        prove(widened.mesh, shells, 0.05)
        limited.append(sum(limited_area(shells, ear.low - bound, ear.high + bound) for ear in ears))
    assert limited[1] < 0.9 * limited[0]
    changes, findings = describe_move(widened, 3.0)
    (change,), (finding,) = changes, findings
    assert 0 < change["mean_mm"] < change["largest_mm"] <= 3.0
    assert change["vertices"] == int((widened.moved_mm > 0).sum()) < 0.2 * len(skin.vertices)
    assert (finding.code, finding.count) == ("skin.moved_outwards", change["places"])
    assert widened.moved_mm[finding.places[0].vertices[0]] > 1.0


@pytest.mark.parametrize("bound", [-0.1, 5.1, float("nan"), float("inf"), "far"])
def test_bounds_that_make_no_sense_are_refused(bound: object) -> None:
    with pytest.raises(ValidationError, match="skin_shift_mm"):
        wanted(skin_shift_mm=bound)
