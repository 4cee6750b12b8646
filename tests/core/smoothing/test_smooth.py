"""What smoothing promises, held against closed forms, the thesis' example and the real body."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from core.errors import InputError, InternalError
from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.deviation import measure_deviation
from core.geometry.distance import smallest_gap
from core.geometry.exact_intersection import find_intersecting_faces, find_intersecting_faces_between
from core.geometry.normals import face_crosses
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
from core.mesh import Mesh
from core.schema.smooth import SmoothInputs
from core.smoothing.smooth import Smoothed, smooth
from subjects.body import body
from subjects.plate import HOLE_MM, HOLE_RADIUS_MM, SIZE_MM, plate
from tests.solids import cube, flipped, moebius_strip, octahedron, sphere, together, torus, with_faces

UPLOAD = {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}
METHODS = ["standard", "lumped", "cvt", "wcc", "hc", "taubin"]


def smoothed(mesh: Mesh, **wanted) -> Smoothed:
    return smooth({"it": mesh}, SmoothInputs(mesh=UPLOAD, **wanted))["it"]


def volume(mesh: Mesh) -> float:
    return float(signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0])


def rough(mesh: Mesh, amount: float, seed: int = 0) -> Mesh:
    """The mesh with noise on every coordinate."""
    noise = np.random.default_rng(seed).normal(0.0, amount, mesh.vertices.shape)
    return mesh.with_vertices(mesh.vertices + noise).rounded_to_float32()


# --- the planar example of the thesis -------------------------------------------------------------------------------


def test_plate_is_the_example_of_the_thesis():
    mesh = plate()
    q = quality(mesh.vertices, mesh.faces)
    assert q.min() == pytest.approx(4e-5, rel=0.01)
    assert (face_crosses(mesh.vertices, mesh.faces)[:, 2] > 0).all()
    middle = np.array(HOLE_MM)
    assert (np.linalg.norm(mesh.vertices[:, :2] - middle, axis=1) > HOLE_RADIUS_MM * (1 - 1e-9)).all()
    assert mesh.extents_mm() == pytest.approx([SIZE_MM, SIZE_MM, 0.0])


def test_wcc_reaches_the_quality_of_fig_29_in_nine_iterations():
    mesh = plate()
    result = smoothed(mesh, method="wcc", iterations=9)
    assert result.progress[0].lowest_quality == pytest.approx(4e-5, rel=0.01)
    assert result.progress[result.delivered].lowest_quality > 0.69  # the thesis has 0.69
    assert quality(result.mesh.vertices, result.mesh.faces).min() == result.progress[result.delivered].lowest_quality


@pytest.mark.parametrize("method", ["standard", "lumped", "cvt", "wcc"])
@pytest.mark.parametrize("retriangulate", [False, True])
def test_every_equation_lifts_the_plate_and_leaves_its_rims(method, retriangulate):
    mesh = plate()
    result = smoothed(mesh, method=method, retriangulate=retriangulate)
    after = result.mesh
    assert quality(after.vertices, after.faces).min() > 0.6
    rim = (mesh.vertices[:, :2] % SIZE_MM == 0).any(axis=1)
    rim |= np.isclose(np.linalg.norm(mesh.vertices[:, :2] - HOLE_MM, axis=1), HOLE_RADIUS_MM)
    assert (after.vertices[rim] == mesh.rounded_to_float32().vertices[rim]).all()
    assert (after.vertices[:, 2] == 0).all()
    assert (face_crosses(after.vertices, after.faces)[:, 2] > 0).all()
    assert len(find_intersecting_faces(after.vertices, after.faces)) == 0
    if not retriangulate:
        assert (after.faces == mesh.faces).all()


def test_plate_keeps_its_area_whatever_moves_inside():
    mesh = plate().rounded_to_float32()
    result = smoothed(mesh, method="standard")
    areas = [np.linalg.norm(face_crosses(m.vertices, m.faces), axis=1).sum() / 2 for m in (mesh, result.mesh)]
    assert areas[1] == pytest.approx(areas[0], rel=1e-12)
    assert result.progress[-1].volume_mm3 is None
    assert result.changes[0]["volume_change"] is None


def test_flips_make_a_coarse_plate_delaunay_where_smoothing_alone_gets_stuck():
    mesh = plate(5.0)
    fixed = smoothed(mesh, method="standard", iterations=30)
    free = smoothed(mesh, method="standard", iterations=30, retriangulate=True)
    assert quality(fixed.mesh.vertices, fixed.mesh.faces).min() < 0.5 < 0.6
    assert quality(free.mesh.vertices, free.mesh.faces).min() > 0.6
    assert free.changes[0]["edges_flipped"] > 0


# --- volume ---------------------------------------------------------------------------------------------------------


def test_standard_shrinks_a_noisy_sphere_and_hc_and_taubin_do_not():
    mesh = rough(sphere(100.0, 4), 0.7)
    spread = {}
    change = {}
    for method in ("standard", "hc", "taubin"):
        result = smoothed(mesh, method=method, stop="iterations", iterations=10)
        change[method] = volume(result.mesh) / volume(mesh) - 1
        assert result.changes[0]["volume_change"] == pytest.approx(change[method], rel=1e-6)
        radii = np.linalg.norm(result.mesh.vertices, axis=1)
        spread[method] = radii.std()
    assert change["standard"] < -0.05
    assert abs(change["hc"]) < 0.005
    assert abs(change["taubin"]) < 0.01
    before = np.linalg.norm(mesh.vertices, axis=1).std()
    assert max(spread["hc"], spread["taubin"]) < 0.5 * before


@pytest.mark.parametrize("method", ["standard", "hc", "taubin"])
def test_many_iterations_agree_with_another_program(method):
    mesh = rough(sphere(100.0, 3), 0.5)
    peer = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    uniform = trimesh.smoothing.laplacian_calculation(peer, equal_weight=True)
    if method == "standard":
        wanted = {"weight": 0.5}
        trimesh.smoothing.filter_laplacian(peer, 0.5, 8, volume_constraint=False, laplacian_operator=uniform)
    elif method == "hc":
        wanted = {"hc_alpha": 0.2, "hc_beta": 0.7}
        trimesh.smoothing.filter_humphrey(peer, 0.2, 0.7, 8, uniform)
    else:
        wanted = {"taubin_lambda": 0.5, "taubin_mu": -0.53}
        trimesh.smoothing.filter_taubin(peer, 0.5, 0.53, 16, uniform)  # it counts single steps
    result = smoothed(mesh, method=method, stop="iterations", iterations=8, **wanted)
    assert not result.findings or result.findings[0].code == "smooth.volume_changed"
    assert result.mesh.vertices == pytest.approx(np.asarray(peer.vertices), abs=1e-4)
    assert result.shift_mm.max() > 0.5


def test_octahedron_shrinks_by_the_weight_cubed():
    # every vertex' neighbours have their mean in the centre, so a share w of the way leaves (1 - w)³ of the volume
    mesh = octahedron(64.0)
    result = smoothed(mesh, method="standard", weight=0.25, iterations=1, stop="iterations")
    assert volume(result.mesh) == pytest.approx(0.75**3 * volume(mesh))
    assert result.changes[0]["volume_change"] == pytest.approx(0.75**3 - 1)
    assert [finding.code for finding in result.findings] == ["smooth.volume_changed"]
    assert result.shift_mm == pytest.approx(16.0)


def test_along_the_surface_the_shape_stays():
    mesh = rough(sphere(100.0, 4), 0.0)
    free = smoothed(mesh, method="cvt", iterations=10, stop="iterations")
    held = smoothed(mesh, method="cvt", iterations=10, stop="iterations", along_surface=True)
    assert held.deviation_mm.max() < 1e-4 < 0.1 < free.deviation_mm.max()
    lost = [1 - volume(result.mesh) / volume(mesh) for result in (held, free)]
    assert 0 < lost[0] < 0.1 * lost[1]


# --- soundness ------------------------------------------------------------------------------------------------------


def test_a_vertex_is_not_pushed_out_of_a_bent_polygon():
    # the mean of the corners of this arrow head lies outside it, so the literal step would turn faces over
    corners = [[0, 0, 0], [10, 0, 0], [9, 1, 0], [1, 1, 0], [1, 9, 0], [0, 10, 0]]
    mesh = Mesh.of([*corners, [0.5, 0.5, 0]], [[i, (i + 1) % 6, 6] for i in range(6)])
    target = np.mean(corners, axis=0)
    assert (face_crosses(np.array([*corners, target]), mesh.faces)[:, 2] < 0).any()
    result = smoothed(mesh, method="standard", stop="iterations", iterations=30)
    assert (face_crosses(result.mesh.vertices, result.mesh.faces)[:, 2] > 0).all()
    assert result.progress[1].shortened + result.progress[1].held == 1
    assert "smooth.steps_shortened" in {finding.code for finding in result.findings}


def test_a_thin_wall_stops_before_it_runs_through_itself():
    # a hollow ball in one mesh: without guards the coarse outer wall shrinks through the finer inner one
    wall = together(sphere(10.0, 2), flipped(sphere(8.5, 3, at=(0.6, 0.3, 0.2))))
    vertices = wall.vertices
    ends = [wall.faces[:, [i, (i + 1) % 3]] for i in range(3)]
    ring = np.concatenate(ends)
    for _ in range(2):
        sums, count = np.zeros_like(vertices), np.bincount(ring[:, 0])
        np.add.at(sums, ring[:, 0], vertices[ring[:, 1]])
        vertices = sums / count[:, None]
    assert len(find_intersecting_faces(vertices, wall.faces)) > 0
    result = smoothed(wall, method="standard", stop="iterations", iterations=15)
    assert len(find_intersecting_faces(result.mesh.vertices, result.mesh.faces)) == 0
    assert sum(state.held for state in result.progress) > 0
    outer, inner = result.mesh.vertices[:66], result.mesh.vertices[66:]
    assert np.linalg.norm(outer, axis=1).min() > np.linalg.norm(inner, axis=1).min()


def test_a_piece_does_not_jump_through_another():
    # one step of the outer octahedron takes it to 2.5, past the inner one at 5, and nothing would meet on arrival
    outer, inner = octahedron(10.0), flipped(octahedron(5.0))
    both = together(outer, inner)
    box = {"min": (-11, -11, -11), "max": (11, 11, 11)}
    literal = both.vertices * np.repeat([0.25, 1.0], 6)[:, None]
    assert len(find_intersecting_faces(literal, both.faces)) == 0
    surfaces = {"outer": outer, "inner": octahedron(5.0)}
    wanted = {"method": "standard", "weight": 0.75, "stop": "iterations", "iterations": 1}
    inputs = SmoothInputs(meshes=dict.fromkeys(surfaces, UPLOAD), regions=[{"name": "all", "box_mm": box}], **wanted)
    apart = smooth(surfaces, inputs)
    assert volume(apart["outer"].mesh) > volume(surfaces["inner"]) > volume(apart["inner"].mesh)
    hollow = smoothed(both, **wanted).mesh
    radii = np.linalg.norm(hollow.vertices, axis=1)
    assert radii[:6].min() > radii[6:].max()


def test_shells_shrunk_onto_each_other_keep_the_gap():
    surfaces = {"outer": sphere(12.0, 2), "inner": sphere(10.0, 3), "core": sphere(8.0, 2)}
    inputs = SmoothInputs(
        meshes=dict.fromkeys(surfaces, UPLOAD), method="standard", stop="iterations", iterations=15, min_gap_mm=0.3
    )
    results = smooth(surfaces, inputs)
    meshes = [results[name].mesh for name in surfaces]
    alone = smoothed(surfaces["outer"], method="standard", stop="iterations", iterations=15).mesh
    assert np.linalg.norm(alone.vertices, axis=1).max() < np.linalg.norm(meshes[1].vertices, axis=1).max()
    for a, b in ((0, 1), (1, 2), (0, 2)):
        assert smallest_gap(meshes[a], meshes[b])[0] >= 0.3
        assert len(find_intersecting_faces_between(meshes[a], meshes[b])) == 0
    assert volume(meshes[0]) > volume(meshes[1]) > volume(meshes[2])


def test_slivers_of_the_input_do_not_hold_their_neighbours():
    # a needle's far side is nearer than any clearance: crowded from the start, tested exactly, and mended
    mesh = rough(torus(30.0, 10.0, 40, 24), 0.0)
    vertices = mesh.vertices.copy()
    a, b, _c = mesh.faces[100]
    vertices[a] = vertices[b] + 1e-4 * (vertices[a] - vertices[b])
    spoiled = mesh.with_vertices(vertices).rounded_to_float32()
    everything = np.arange(len(spoiled.faces))
    surface = MovingSurface(spoiled.vertices, spoiled.faces)
    assert len(surface.find_crowded(spoiled.vertices, everything, Clearance(0.05, 0.01, ()))) > 0
    assert quality(spoiled.vertices, spoiled.faces).min() < 1e-4
    result = smoothed(spoiled, method="cvt")
    assert quality(result.mesh.vertices, result.mesh.faces).min() > 0.3
    assert len(find_intersecting_faces(result.mesh.vertices, result.mesh.faces)) == 0


@settings(max_examples=25)
@given(
    method=st.sampled_from(METHODS),
    shape=st.sampled_from(["sphere", "torus", "plate"]),
    amount=st.floats(0.0, 0.6),
    seed=st.integers(0, 10_000),
    stop=st.sampled_from(["quality", "iterations"]),
    iterations=st.integers(1, 6),
    along_surface=st.booleans(),
    region=st.one_of(st.none(), st.tuples(st.floats(-12.0, 0.0), st.floats(2.0, 14.0))),
)
def test_a_sound_surface_stays_sound(method, shape, amount, seed, stop, iterations, along_surface, region):
    base = {"sphere": sphere(10.0, 2), "torus": torus(9.0, 3.0, 20, 12), "plate": plate(12.0)}[shape]
    mesh = rough(base, amount, seed)
    wanted = {"method": method, "stop": stop, "iterations": iterations, "along_surface": along_surface}
    inside = np.ones(len(mesh.vertices), dtype=bool)
    if region is not None:
        low, high = [region[0]] * 3, [region[0] + region[1]] * 3
        inside = ((mesh.vertices >= low) & (mesh.vertices <= high)).all(axis=1)
        wanted["regions"] = [{"name": "here", "box_mm": {"min": low, "max": high}}]
    fit = len(find_intersecting_faces(mesh.vertices, mesh.faces)) == 0
    try:
        result = smoothed(mesh, **wanted)
    except InputError as error:
        refused = error.code
    else:
        refused = None
    assert refused == ("region.outside_mesh" if not inside.any() else None if fit else "surface.self_intersecting")
    if refused is not None:
        return
    after = result.mesh
    assert fit
    assert len(find_intersecting_faces(after.vertices, after.faces)) == 0
    assert (after.faces == mesh.faces).all()
    assert (after.vertices[~inside] == mesh.vertices[~inside]).all()
    assert (after.vertices == after.vertices.astype(np.float32)).all()
    least = quality(mesh.vertices, mesh.faces).min()
    assert quality(after.vertices, after.faces).min() >= min(least, 0.05 if stop == "iterations" else 1.0) * (1 - 1e-6)
    again = smoothed(mesh, **wanted)
    assert (again.mesh.vertices == after.vertices).all()
    assert again.changes == result.changes


# --- the body -------------------------------------------------------------------------------------------------------


def test_body_is_better_and_whole_after_smoothing():
    mesh = body(0)
    result = smoothed(mesh)
    q = [quality(m.vertices, m.faces) for m in (mesh, result.mesh)]
    assert q[1].min() > 2 * q[0].min()
    assert q[1].mean() > q[0].mean()
    assert abs(volume(result.mesh) / volume(mesh) - 1) < 0.005
    assert len(find_intersecting_faces(result.mesh.vertices, result.mesh.faces)) == 0
    assert (result.mesh.faces == mesh.faces).all()
    # what is told is what is
    assert result.progress[result.delivered].lowest_quality == q[1].min()
    assert result.shift_mm.max() == pytest.approx(result.progress[result.delivered].largest_shift_mm)


def test_region_moves_and_nothing_else():
    mesh = body(0)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    low = np.array([low[0], high[1] - 250.0, low[2]])
    region = {"name": "head", "box_mm": {"min": low.tolist(), "max": high.tolist()}}
    result = smoothed(mesh, method="taubin", stop="iterations", iterations=5, regions=[region])
    inside = (mesh.vertices >= low).all(axis=1)
    moved = (result.mesh.vertices != mesh.vertices).any(axis=1)
    assert 0 < inside.sum() < len(inside)
    assert not moved[~inside].any()
    assert moved[inside].mean() > 0.99


def test_all_iterations_are_made_if_asked_for():
    mesh = rough(sphere(10.0, 2), 0.1)
    result = smoothed(mesh, method="hc", stop="iterations", iterations=12)
    assert [state.iteration for state in result.progress] == list(range(13))
    assert result.delivered == 12


def test_best_iteration_is_delivered_and_named():
    mesh = rough(sphere(10.0, 2), 0.3)
    result = smoothed(mesh, method="standard", iterations=40)
    lowest = [state.lowest_quality for state in result.progress]
    assert result.best == result.delivered < len(lowest) - 1 < 40
    assert lowest == sorted(lowest)  # it never falls
    assert max(lowest) <= 1.001 * lowest[result.best]
    assert quality(result.mesh.vertices, result.mesh.faces).min() == lowest[result.best]
    assert result.changes[0]["iteration_best"] == result.best


def test_what_cannot_rise_is_left_alone_and_said():
    # the outer box of equal triangles cannot be made better than it is
    result = smoothed(octahedron(10.0))
    assert (result.mesh.vertices == octahedron(10.0).vertices).all()
    assert [finding.code for finding in result.findings] == ["smooth.no_gain"]


def test_no_vertex_goes_farther_than_allowed():
    mesh = rough(sphere(10.0, 3), 0.2)
    result = smoothed(mesh, method="standard", stop="iterations", max_shift_mm=0.05)
    assert 0.049 < result.shift_mm.max() <= 0.05
    # without flips no point between the vertices goes farther than they do
    assert max(result.deviation_mm.max(), result.original_deviation_mm.max()) <= 0.05
    assert measure_deviation(result.original, result.mesh).maximum_mm <= 0.05


def test_with_flips_vertices_keep_to_what_is_allowed_and_the_surface_is_told_apart():
    mesh = rough(torus(10.0, 4.0, 60, 24), 0.02)
    result = smoothed(mesh, method="standard", stop="iterations", max_shift_mm=0.2, retriangulate=True)
    told = result.changes[0]
    assert told["edges_flipped"] > 0
    assert 0.19 < result.shift_mm.max() <= 0.2
    assert told["largest_shift_mm"] == pytest.approx(result.shift_mm.max(), rel=1e-4)
    assert told["max_deviation_mm"] == pytest.approx(max(result.deviation_mm.max(), result.original_deviation_mm.max()), rel=1e-4)


def test_a_vertex_that_went_too_far_is_not_handed_out(monkeypatch):
    monkeypatch.setattr("core.smoothing.proposal._hold_near", lambda *_: None)
    with pytest.raises(InternalError, match="from where it was") as error:
        smoothed(rough(sphere(10.0, 3), 0.2), method="standard", stop="iterations", max_shift_mm=0.05)
    assert error.value.code == "smooth.not_proven"


def test_flips_stay_inside_the_region():
    mesh = plate(5.0)
    region = {"name": "left", "box_mm": {"min": (-1, -1, -1), "max": (50, 101, 1)}}
    result = smoothed(mesh, method="standard", iterations=30, retriangulate=True, regions=[region])
    outside = (mesh.vertices[mesh.faces][:, :, 0] > 50).any(axis=1)
    assert result.changes[0]["edges_flipped"] > 0
    assert (result.mesh.faces[outside] == mesh.faces[outside]).all()


# --- bad input ------------------------------------------------------------------------------------------------------


def _folded_over() -> Mesh:
    mesh = sphere(10.0, 2)
    vertices = mesh.vertices.copy()
    vertices[0] *= -1.3
    return mesh.with_vertices(vertices)


def _flat_face() -> Mesh:
    mesh = cube(10.0)
    return with_faces(mesh, [[0, 0, 1]])


@pytest.mark.parametrize(
    ("mesh", "code"),
    [
        (_folded_over(), "surface.self_intersecting"),
        (_flat_face(), "surface.degenerate"),
        (flipped(cube(10.0), [0]), "surface.not_oriented"),
        (moebius_strip(), "surface.not_oriented"),
        (with_faces(cube(10.0), [[0, 1, 7]]), "surface.not_manifold"),
        (together(cube(10.0), cube(10.0, at=(10.0, 10.0, 10.0))), "surface.self_touching"),
    ],
)
def test_unsound_surfaces_are_refused_with_a_hint(mesh, code):
    before = mesh.vertices.copy()
    with pytest.raises(InputError, match="heal") as caught:
        smoothed(mesh)
    assert caught.value.code == code
    assert caught.value.findings
    assert (mesh.vertices == before).all()


def test_surfaces_too_close_already_are_refused():
    surfaces = {"a": sphere(10.0, 3), "b": sphere(9.96, 3)}
    with pytest.raises(InputError, match="smaller min_gap_mm") as caught:
        smooth(surfaces, SmoothInputs(meshes=dict.fromkeys(surfaces, UPLOAD)))
    assert caught.value.code == "surfaces.too_close"
    assert 0.03 < caught.value.facts["gap_mm"] < 0.05


def test_region_off_the_mesh_is_refused_with_extents():
    region = {"name": "nowhere", "box_mm": {"min": (50, 50, 50), "max": (60, 60, 60)}}
    with pytest.raises(InputError, match=r"nowhere.*-10") as caught:
        smoothed(sphere(10.0, 2), regions=[region])
    assert caught.value.code == "region.outside_mesh"
