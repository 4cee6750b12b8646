import time

import numpy as np
import pytest

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.run import RunContext, RunEvent
from core.schema.finding import Severity
from core.validation.validate import validate
from subjects.body import body
from tests.solids import cube, flipped, moebius_strip, octahedron, sphere, tetrahedron, together, torus, with_faces, without_faces


def codes(validation):
    return {finding.code for finding in validation.findings}


def test_numbers_of_a_cube():
    report = validate({"box": cube(2.0, at=(5, 5, 5))}).meshes["box"]
    assert (report.vertices, report.faces, report.components, report.euler_characteristic, report.genus) == (8, 12, 1, 2, 0)
    assert report.closed
    assert report.edge_manifold
    assert report.vertex_manifold
    assert report.consistently_oriented
    assert report.oriented_outward is True
    assert (report.area_mm2, report.volume_mm3, report.extents_mm) == (24.0, 8.0, (2.0, 2.0, 2.0))
    assert report.quality.minimum == report.quality.median == report.quality.mean == pytest.approx(2 * (np.sqrt(2) - 1))
    assert (report.edges.minimum_mm, report.edges.median_mm) == (2.0, 2.0)
    assert report.edges.maximum_mm == pytest.approx(np.sqrt(8))
    assert report.minimum_dihedral_deg == 90.0


@pytest.mark.parametrize(
    ("mesh", "euler", "genus"),
    [
        (tetrahedron(), 2, 0),
        (torus(), 0, 1),
        (together(torus(), sphere(at=(9, 0, 0))), 2, 1),
        (together(torus(), torus(10.0, 1.0)), 0, 2),
        (flipped(torus(), [3]), 0, 1),
        (moebius_strip(), 0, None),
        (without_faces(cube(), [0]), 1, None),
    ],
    ids=["tetrahedron", "torus", "torus and sphere", "two tori", "torus with a turned face", "Möbius strip", "open cube"],
)
def test_euler_characteristic_and_genus(mesh, euler, genus):
    report = validate({"it": mesh}).meshes["it"]
    assert (report.euler_characteristic, report.genus) == (euler, genus)


def test_a_one_sided_closed_surface_has_no_genus():
    # the projective plane: an icosahedron's half, glued with itself; closed and manifold, never orientable
    faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5], [0, 5, 1], [1, 2, 4], [2, 3, 5], [3, 4, 1], [4, 5, 2], [5, 1, 3]]
    report = validate({"it": Mesh.of(np.random.default_rng(1).normal(size=(6, 3)), faces)}).meshes["it"]
    assert report.closed
    assert report.edge_manifold
    assert (report.euler_characteristic, report.genus, report.volume_mm3, report.oriented_outward) == (1, None, None, None)


def test_volume_and_outwardness_with_a_cavity():
    hollow = together(cube(4.0), flipped(cube(2.0, at=(1, 1, 1))))
    report = validate({"it": hollow}).meshes["it"]
    assert (report.volume_mm3, report.oriented_outward, report.components, report.genus) == (64.0 - 8.0, True, 2, 0)
    assert validate({"it": flipped(hollow)}).meshes["it"].oriented_outward is False


def test_verdicts():
    assert validate({"it": sphere()}).verdict == "simulation_ready"
    needle = octahedron().with_vertices(octahedron().vertices * [1, 1, 1e-4])
    flat = validate({"it": needle})
    assert {finding.severity for finding in flat.findings} == {Severity.WARNING}
    assert flat.verdict == "simulation_ready"
    for bad in (without_faces(cube(), [0]), flipped(cube()), with_faces(cube(), [cube().faces[0]]), moebius_strip()):
        assert validate({"it": bad}).verdict == "not_ready"


def test_nested_spheres():
    meshes = {"core": sphere(1.0, 3), "skin": sphere(4.0, 3), "fat": sphere(3.0, 3), "far": sphere(1.0, 3, at=(20, 0, 0))}
    found = validate(meshes)
    assert found.verdict == "simulation_ready"
    assert found.findings == ()
    assert found.nesting == {"core": "fat", "skin": None, "fat": "skin", "far": None}
    relations = {(pair.a, pair.b): pair.relation for pair in found.pairs}
    assert relations == {
        ("core", "skin"): "a_inside_b",
        ("core", "fat"): "a_inside_b",
        ("core", "far"): "disjoint",
        ("skin", "fat"): "b_inside_a",
        ("skin", "far"): "disjoint",
        ("fat", "far"): "disjoint",
    }
    gaps = {(pair.a, pair.b): pair.min_gap_mm for pair in found.pairs}
    # the spheres are similar, so faces are parallel: the gap is that of the flattest face, as far from the centre as its middle
    inradius = np.linalg.norm(sphere(1.0, 3).triangles().mean(axis=1), axis=1).min()
    assert gaps["skin", "fat"] == pytest.approx(1.0, abs=2 * (1 - inradius))
    assert gaps["skin", "far"] == pytest.approx(15.0)


def test_two_children_in_one_parent():
    found = validate({"left": cube(1.0, at=(1, 1, 1)), "right": cube(1.0, at=(3, 1, 1)), "box": cube(5.0)})
    assert found.nesting == {"left": "box", "right": "box", "box": None}
    assert [pair.min_gap_mm for pair in found.pairs] == [1.0, 1.0, 1.0]


def test_crossing_meshes_and_their_cases():
    found = validate({"big": tetrahedron(), "small": tetrahedron(0.2, at=(0.2, 0.2, -0.1))})
    (pair,) = found.pairs
    assert (pair.relation, pair.intersecting_pairs, pair.min_gap_mm) == ("intersecting", 3, 0.0)
    assert (pair.case_1, pair.case_2, pair.case_3) == (3, 0, 0)
    (finding,) = found.findings
    assert (finding.code, finding.count) == ("pair.intersecting", 3)
    assert {(place.mesh, place.faces) for place in finding.places} == {("big", (0,)), ("small", (1, 2, 3))}
    (swapped,) = validate({"small": tetrahedron(0.2, at=(0.2, 0.2, -0.1)), "big": tetrahedron()}).pairs
    assert (swapped.case_1, swapped.case_2, swapped.case_3) == (0, 0, 3)


def test_two_needles_across_each_other_are_case_two():
    # each has an edge that cuts into the other: faces meet side through face both ways
    a = Mesh.of([[-5, -1, 0], [5, -1, 0], [0, 1, 0.5], [0, 1, -0.5]], tetrahedron().faces)
    b = Mesh.of([[0, 1.5, -5], [0, 1.5, 5], [0.5, 0.5, 0], [-0.5, 0.5, 0]], tetrahedron().faces)
    (pair,) = validate({"a": a, "b": b}).pairs
    assert pair.case_2 > 0
    assert pair.case_1 + pair.case_2 + pair.case_3 == pair.intersecting_pairs


def test_touching_is_an_error_although_the_exact_test_finds_nothing():
    found = validate({"a": cube(), "b": cube(at=(1, 1, 1))})
    (pair,) = found.pairs
    assert (pair.intersecting_pairs, pair.min_gap_mm, pair.min_gap_point_mm) == (0, 0.0, (1.0, 1.0, 1.0))
    assert codes(found) == {"pair.touching"}
    assert found.verdict == "not_ready"


def test_touching_from_inside_far_from_the_origin():
    # the common corner is the second or third of its faces: rounding must not turn contact into a gap of one step
    at = np.array([1234.567, -987.654, 333.333])
    outer, inner = sphere(7.3, 3, at=at), sphere(7.3, 3, at=at)
    shrunk = at + (inner.vertices - at) * 0.9
    for vertex in range(0, len(shrunk), 29):
        poked = shrunk.copy()
        poked[vertex] = outer.vertices[vertex]
        assert "pair.touching" in codes(validate({"skin": outer, "fat": inner.with_vertices(poked)}))


def test_a_face_on_a_face_is_an_intersection():
    found = validate({"a": cube(), "b": cube(at=(1, 0, 0))})
    assert codes(found) == {"pair.intersecting"}
    assert found.pairs[0].intersecting_pairs == 2


def test_minimum_gap():
    meshes = {"outer": cube(4.0), "inner": cube(3.0, at=(0.25, 0.5, 0.5))}
    assert validate(meshes, min_gap_mm=0.25).verdict == "simulation_ready"
    found = validate(meshes, min_gap_mm=0.26)
    (finding,) = found.findings
    assert (finding.code, finding.severity) == ("pair.gap_too_small", Severity.ERROR)
    assert "0.25 mm" in finding.message
    assert finding.places[0].point_mm[0] == 0.125
    assert {place.mesh for place in finding.places} == {"outer", "inner"}


def test_many_vertices_too_close_are_counted_closest_first():
    found = validate({"inner": sphere(9.5, 3), "outer": sphere(10.0, 3)}, min_gap_mm=1.0)
    (finding,) = found.findings
    assert finding.count == len(sphere(9.5, 3).vertices)
    assert len(finding.places) == 100


def test_pieces_on_both_sides_are_a_warning():
    found = validate({"crumbs": together(cube(1.0, at=(1, 1, 1)), cube(1.0, at=(9, 9, 9))), "box": cube(4.0)})
    assert found.pairs[0].relation == "undetermined"
    assert codes(found) == {"mesh.several_components", "pair.partly_inside"}
    assert "50%" in next(finding.message for finding in found.findings if finding.code == "pair.partly_inside")
    assert found.verdict == "simulation_ready"


def test_a_mesh_within_the_cavity_of_another_is_not_inside_it():
    hollow = together(cube(6.0), flipped(cube(4.0, at=(1, 1, 1))))
    found = validate({"hollow": hollow, "kernel": cube(1.0, at=(2, 2, 2)), "shell": cube(5.0, at=(0.5, 0.5, 0.5))})
    relations = {(pair.a, pair.b): pair.relation for pair in found.pairs}
    assert relations["hollow", "kernel"] == "disjoint"
    assert relations["hollow", "shell"] == "b_inside_a"  # it lies in the wall, around the cavity
    assert found.nesting["kernel"] == "shell"


def test_open_meshes_enclose_nothing():
    found = validate({"open": without_faces(cube(4.0), [0]), "inner": cube(1.0, at=(1, 1, 1))})
    assert found.pairs[0].relation == "undetermined"
    assert found.pairs[0].min_gap_mm == 1.0
    assert found.nesting == {"open": None, "inner": None}
    sheet = Mesh.of([[1, 1, 1], [2, 1, 1], [1, 2, 1]], [[0, 1, 2]])
    assert validate({"sheet": sheet, "box": cube(4.0)}).nesting == {"sheet": "box", "box": None}


def test_the_body_is_clean():
    found = validate({"skin": body()})
    assert found.findings == ()
    assert found.verdict == "simulation_ready"
    report = found.meshes["skin"]
    assert (report.vertices, report.faces, report.components, report.genus) == (13380, 26756, 1, 0)
    assert report.oriented_outward is True
    assert 50e6 < report.volume_mm3 < 60e6  # a body of fifty-odd litres


def test_full_resolution_takes_less_than_two_seconds_on_one_core():
    validate({"a": sphere(), "b": sphere(2.0)})  # kernels compile before the clock starts
    mesh = body(1)
    started = time.process_time()
    found = validate({"skin": mesh})
    assert time.process_time() - started < 2.0
    assert found.verdict == "simulation_ready"
    assert found.meshes["skin"].faces == 107024


def test_the_body_moved_along_its_normals_runs_through_itself():
    moved = body().with_vertices(body().vertices - 3.0 * vertex_normals(body().vertices, body().faces))
    found = validate({"fat": moved})
    assert found.verdict == "not_ready"
    (finding,) = [finding for finding in found.findings if finding.code == "mesh.self_intersecting"]
    assert finding.count == found.meshes["fat"].self_intersecting_pairs > 1000
    assert 1 < len(finding.places) <= 100  # ears, eyelids, fingers ...


def test_all_lines_still_have_a_report():
    found = validate({"lines": Mesh.of(np.eye(3), [[0, 1, 1], [2, 2, 2]]), "box": cube(at=(5, 0, 0))})
    assert found.verdict == "not_ready"
    report = found.meshes["lines"]
    assert (report.components, report.closed, report.degenerate_faces, report.minimum_dihedral_deg) == (0, False, 2, None)
    assert found.pairs[0].min_gap_mm == pytest.approx(4.0)


def test_progress_rises_to_the_end():
    events: list[RunEvent] = []
    validate({"a": sphere(1.0), "b": sphere(2.0)}, run=RunContext(events.append))
    progress = [event.progress for event in events]
    assert progress == sorted(progress)
    assert progress[-1] == 100.0
    assert {event.phase for event in events} == {"validate: intersections", "validate: meshes", "validate: pairs"}


def test_same_input_same_result():
    moved = body().with_vertices(body().vertices - vertex_normals(body().vertices, body().faces))
    first, second = (validate({"skin": body(), "fat": moved}) for _ in range(2))
    assert first == second
