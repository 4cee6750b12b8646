"""Regions of one surface set into another: the promises on solids of every tessellation, and the refusals by name."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError, LimitError
from core.grafting.graft import Graft, graft
from core.grafting.wall import Box, wall_distance
from core.mesh import Mesh
from core.validation.validate import validate
from tests.solids import cube, sphere, torus

TOP: Box = ((-100.0, -100.0, 20.0), (100.0, 100.0, 100.0))
BOTTOM: Box = ((-100.0, -100.0, -100.0), (100.0, 100.0, -20.0))
WAIST: Box = ((-100.0, -100.0, -15.0), (100.0, 100.0, 15.0))
OCTANT: Box = ((0.0, 0.0, 0.0), (100.0, 100.0, 100.0))
SEAM_MM = 4.0


def rounded(mesh: Mesh) -> Mesh:
    return mesh.rounded_to_float32()


def graft_rounded(base: Mesh, donor: Mesh, *boxes: Box, seam_mm: float = SEAM_MM, max_distance_mm: float = 6.0) -> Graft:
    return graft(rounded(base), rounded(donor), boxes, seam_mm=seam_mm, max_distance_mm=max_distance_mm)


def rows(points: np.ndarray) -> set[bytes]:
    return {row.tobytes() for row in np.ascontiguousarray(points) + 0.0}


def require_kept_promises(made: Graft, base: Mesh, donor: Mesh, boxes: tuple[Box, ...], seam_mm: float, genus: int = 0) -> None:
    """One proven surface; away from the seams it is made of the corners of base and donor and has all of them."""
    validation = validate({"made": made.mesh})
    assert validation.verdict == "simulation_ready", validation.findings
    report = validation.meshes["made"]
    assert (report.components, report.genus) == (1, genus)
    assert made.base_faces + made.donor_faces + made.band_faces == len(made.mesh.faces)
    rim_mm = seam_mm / 2 + 2 * 0.6 * seam_mm  # two faces of the finest size beyond the margin
    have = rows(made.mesh.vertices)
    for mesh, sign in ((rounded(base), 1.0), (rounded(donor), -1.0)):
        beyond = wall_distance(mesh.vertices, boxes) * sign > rim_mm
        assert rows(mesh.vertices[beyond]) <= have
    assert (made.mesh.vertices == made.mesh.vertices.astype(np.float32)).all()


@pytest.mark.parametrize("box", [TOP, WAIST, OCTANT], ids=["top", "waist", "octant"])
@pytest.mark.parametrize("donor", [sphere(49, 3), sphere(51, 5), sphere(50, 4)], ids=["coarser", "finer", "the same"])
def test_spheres_of_any_tessellation(donor: Mesh, box: Box) -> None:
    base = sphere(50, 4)
    made = graft_rounded(base, donor, box)
    require_kept_promises(made, base, donor, (box,), SEAM_MM)
    assert len(made.seams) == (2 if box is WAIST else 1)
    radius = np.linalg.norm(made.mesh.vertices, axis=1)
    assert radius.min() >= 47.5  # the band follows the surfaces, with chords across faces of the coarsest
    assert radius.max() <= 51.001


def test_two_regions_and_an_overlap() -> None:
    base, donor = sphere(50, 4), sphere(49, 3)
    beside: Box = ((-100.0, -100.0, 0.0), (0.0, 0.0, 100.0))
    for boxes, seams in (((TOP, BOTTOM), 2), ((TOP, beside), 1)):
        made = graft_rounded(base, donor, *boxes)
        require_kept_promises(made, base, donor, boxes, SEAM_MM)
        assert len(made.seams) == seams


def test_faces_larger_than_the_box() -> None:
    base, donor = cube(100), cube(96, (2, 2, 2))
    for box in (((30.0, 30.0, 50.0), (70.0, 70.0, 200.0)), ((50.0, 50.0, 50.0), (200.0, 200.0, 200.0))):
        made = graft_rounded(base, donor, box)
        require_kept_promises(made, base, donor, (box,), SEAM_MM)


def test_a_handle_stays_a_handle() -> None:
    base, donor = torus(60, 20, 24, 16), torus(60, 19, 40, 30)
    half: Box = ((0.0, -200.0, -200.0), (200.0, 200.0, 200.0))
    require_kept_promises(graft_rounded(base, donor, half), base, donor, (half,), SEAM_MM, genus=1)


def test_same_input_same_result() -> None:
    first, second = (graft_rounded(sphere(50, 3), sphere(49, 4), TOP) for _ in range(2))
    assert np.array_equal(first.mesh.vertices, second.mesh.vertices)
    assert np.array_equal(first.mesh.faces, second.mesh.faces)


def test_numbers_of_the_report() -> None:
    base, donor = sphere(50, 4), sphere(48, 4)
    made = graft_rounded(base, donor, TOP)
    assert 1.9 < made.apart_mm < 2.3
    assert made.base_removed == len(base.faces) + made.bisected[0] - made.base_faces
    (seam,) = made.seams
    assert seam.faces == made.band_faces
    assert 2.0 < seam.widest_mm < 4 * SEAM_MM


def graft_or_refusal(base: Mesh, donor: Mesh, box: Box) -> Graft | InputError:
    try:
        return graft_rounded(base, donor, box, max_distance_mm=30.0)
    except InputError as refusal:
        return refusal


@settings(max_examples=15)
@given(
    radius=st.floats(45, 55),
    tilt=st.floats(-3, 3),
    level=st.floats(-30, 30),
    fineness=st.tuples(st.integers(1, 4), st.integers(1, 4)),
    boxed=st.booleans(),
)
def test_it_is_proven_or_refused(radius: float, tilt: float, level: float, fineness: tuple[int, int], boxed: bool) -> None:
    base = cube(90, (-45 + tilt, -45, -45 - tilt)) if boxed else sphere(50, fineness[0])
    donor = sphere(radius, fineness[1], at=(tilt, -tilt, tilt / 2))
    box: Box = ((-100.0, -100.0, level), (100.0, 100.0, 100.0))
    try:
        made = graft_rounded(base, donor, box, max_distance_mm=30.0)
    except InputError as error:
        refusal = error
    else:
        refusal = None
    if refusal is not None:
        assert refusal.code in {"graft.too_far", "graft.seam_crosses", "graft.loops_do_not_match"}
        assert refusal.findings[0].places
        return
    require_kept_promises(made, base, donor, (box,), SEAM_MM)


@pytest.mark.parametrize(
    ("donor", "boxes", "code"),
    [
        (sphere(49, 3), [((100, 100, 100), (200, 200, 200))], "region.outside_mesh"),
        (sphere(49, 3), [TOP, ((100, 100, 100), (200, 200, 200))], "region.outside_mesh"),
        (sphere(49, 3), [((-100, -100, 48.9), (100, 100, 100))], "region.outside_mesh"),
        (sphere(30, 3, at=(0, 0, 10)), [((-100, -100, 45), (100, 100, 100))], "region.outside_mesh"),
        (sphere(49, 3), [((-100, -100, -100), (100, 100, 100))], "region.covers_mesh"),
        (sphere(49, 3), [((-49, -49, -49), (49, 49, 200))], "region.covers_mesh"),
        (sphere(40, 3), [TOP], "graft.too_far"),
        (torus(30, 15, 40, 30), [((-100, -100, -100), (100, 0, 100))], "graft.loops_do_not_match"),
    ],
)
def test_refusals_by_name(donor: Mesh, boxes: list[Box], code: str) -> None:
    with pytest.raises(InputError) as refusal:
        graft_rounded(sphere(50, 4), donor, *boxes)
    assert refusal.value.code == code
    if code.startswith("graft."):
        (finding, *_) = refusal.value.findings
        assert finding.code == code
        assert finding.places
        assert finding.count >= len(finding.places)


def test_too_far_says_how_far_and_where() -> None:
    with pytest.raises(InputError, match="10 mm from the donor") as refusal:
        graft_rounded(sphere(50, 4), sphere(40, 4), TOP)
    assert refusal.value.facts["distance_mm"] == pytest.approx(10.0, abs=0.2)
    place = np.array(refusal.value.findings[0].places[0].point_mm)
    assert np.linalg.norm(place) == pytest.approx(50.0, abs=0.3)
    made = graft_rounded(sphere(50, 4), sphere(40, 4), TOP, max_distance_mm=11.0, seam_mm=8.0)
    assert validate({"made": made.mesh}).verdict == "simulation_ready"


def plate(thickness: float, z: float) -> Mesh:
    return Mesh.of(cube(1).vertices * (100, 100, thickness) + (0, 0, z), cube(1).faces)


def test_a_seam_that_crosses_is_widened() -> None:
    half: Box = ((50.0, -50.0, -50.0), (150.0, 150.0, 60.0))
    made = graft_rounded(plate(0.5, 0), plate(0.5, 0.3), half, seam_mm=6.0)
    assert made.attempts > 1
    assert validate({"made": made.mesh}).verdict == "simulation_ready"


def test_a_seam_that_crosses_however_wide_is_refused() -> None:
    # halves of thin plates, one above the other: at the rim of each the step is larger than the plate is thick
    half: Box = ((50.0, -50.0, -50.0), (150.0, 150.0, 60.0))
    with pytest.raises(InputError) as refusal:
        graft_rounded(plate(0.5, 0), plate(0.5, 1.0), half, seam_mm=6.0)
    assert refusal.value.code == "graft.seam_crosses"
    assert refusal.value.findings[0].places


def test_a_seam_too_fine_is_a_limit() -> None:
    with pytest.raises(LimitError) as refusal:
        graft_rounded(sphere(5000, 2), sphere(5000, 2), ((-9e3, -9e3, 20), (9e3, 9e3, 9e3)), seam_mm=0.2)
    assert refusal.value.code == "graft.seam_too_fine"
