"""Thousands of faces at one corner: the same pairs as comparing all with all, and not the square of the time."""

from __future__ import annotations

import time
from fractions import Fraction

import igl.copyleft.cgal
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.geometry.coincidence import position_ids
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.fan_intersections import find_fan_faces, find_intersections_of_fans
from core.geometry.fans import MANY_FACES
from core.mesh import Mesh
from tests.solids import sphere, together

TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
MORE = 2 * MANY_FACES


def cone(count: int, *, height: float = 50.0, radius: float = 30.0) -> Mesh:
    """Closed: `count` faces around the tip, and as many around the middle of the base."""
    angle = 2.0 * np.pi * np.arange(count) / count
    rim = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)))
    here, following = np.arange(count) + 2, np.roll(np.arange(count) + 2, -1)
    sides = np.column_stack((np.zeros(count, int), here, following))
    base = np.column_stack((np.ones(count, int), following, here))
    return Mesh.of(np.vstack(([0.0, 0.0, height], [0.0, 0.0, 0.0], rim)), np.vstack((sides, base)))


def turned(mesh: Mesh) -> Mesh:
    return mesh.with_vertices(mesh.vertices @ TURN.T)


def zigzag(count: int) -> Mesh:
    """A fan whose faces run from near one pole to near the other, as seen from its tip, and back."""
    angle = 2.0 * np.pi * np.arange(count) / count
    pole = np.where(np.arange(count) % 2, 1.0, -1.0)
    rim = np.column_stack((0.2 * np.cos(angle), 0.2 * np.sin(angle), pole)) * (10.0 + np.arange(count) % 3)[:, None]
    here = np.arange(count) + 1
    return Mesh.of(np.vstack(([0.0, 0.0, 0.0], rim)), np.column_stack((np.zeros(count, int), here, np.roll(here, -1))))


def book(count: int, doubled: int = 0) -> Mesh:
    """Faces around one edge, at different angles; the last `doubled` lie on others without being equal to them."""
    angle = 2.0 * np.pi * np.arange(count) / count
    tips = np.column_stack((np.cos(angle), np.sin(angle), np.linspace(0.1, 0.9, count)))
    tips = np.vstack((tips, 0.5 * tips[:doubled]))
    faces = [(0, 1, k + 2) for k in range(len(tips))]
    return Mesh.of(np.vstack(([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], tips)), faces)


def all_with_all(mesh: Mesh) -> list[list[int]]:
    """What libigl finds when it is left alone, and of neighbours what fractions say."""
    vertices, faces = np.ascontiguousarray(mesh.vertices), mesh.faces.astype(np.int64)
    found = igl.copyleft.cgal.remesh_self_intersections(vertices, faces, detect_only=True)[2]
    places = position_ids(mesh.vertices)[mesh.faces]
    pairs = {(min(a, b), max(a, b)) for a, b in found.tolist() if len(set(places[a]) & set(places[b])) < 2}
    for a in range(len(faces)):
        for b in np.flatnonzero(np.isin(places, places[a]).sum(axis=1) == 2).tolist():
            if a < b and is_folded_over(vertices, places[a], places[b]):
                pairs.add((a, b))
    return sorted(map(list, pairs))


def is_folded_over(vertices: np.ndarray, one: np.ndarray, other: np.ndarray) -> bool:
    """Faces with two corners in common, with an area: in one plane, and on the same side of that edge."""
    ends = sorted(set(one) & set(other))
    tips = [next(iter(set(face) - set(ends))) for face in (one, other)]
    u, v, p, q = ([Fraction(float(x)) for x in vertices[place]] for place in (*ends, *tips))
    first, second = (
        cross([b - a for a, b in zip(u, v, strict=True)], [b - a for a, b in zip(u, w, strict=True)]) for w in (p, q)
    )
    return not any(cross(first, second)) and sum(a * b for a, b in zip(first, second, strict=True)) > 0


def cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def by_fans(mesh: Mesh) -> list[list[int]]:
    places = position_ids(mesh.vertices)[mesh.faces]
    in_fan = find_fan_faces(places)
    assert in_fan.any()
    plain = np.flatnonzero(~in_fan)
    rest = all_with_all(Mesh.of(mesh.vertices, mesh.faces[plain])) if len(plain) else []
    pairs = find_intersections_of_fans(mesh.vertices, mesh.faces, places, in_fan).tolist()
    return sorted(pairs + [[int(plain[a]), int(plain[b])] for a, b in rest])


SOUND = {
    "cone": cone(MORE),
    "cone, turned": turned(cone(MORE)),
    "flat cone": cone(MORE, height=1e-7),
    "needle": cone(MORE, height=1e6, radius=1e-3),
    "two tips that touch": together(cone(MORE), cone(MORE).with_vertices(cone(MORE).vertices * (1, 1, -1) + (0, 0, 100))),
    "zigzag": zigzag(MORE),
    "zigzag, turned": turned(zigzag(MORE)),
    "book": book(MORE),
}


@pytest.mark.parametrize("name", SOUND)
def test_sound_fans_are_found_sound(name):
    assert by_fans(SOUND[name]) == all_with_all(SOUND[name]) == []


FAULTY = {
    "base through the side": cone(MORE).with_vertices(
        np.vstack((cone(MORE).vertices[:1], [20.0, 0.0, 40.0], cone(MORE).vertices[2:]))
    ),
    "tip in the base": cone(MORE).with_vertices(np.vstack(([0.3, 10.0, 0.0], cone(MORE).vertices[1:]))),
    "ball through the side": together(cone(MORE), sphere(8.0, 2, at=(15.0, 3.0, 20.0))),
    "ball at the tip": together(
        turned(cone(MORE)), sphere(3.0, 2).with_vertices(sphere(3.0, 2).vertices + TURN @ (0.0, 0.0, 50.0))
    ),
    "two cones through each other": together(cone(MORE), turned(cone(MORE))),
    "book with pages that cover others": turned(book(MORE, doubled=9)),
    "all in one line are no faces": together(cone(MORE), Mesh.of([[0, 0, -9], [0, 0, 9], [0, 0, 99]], [[0, 1, 2]])),
}


@pytest.mark.parametrize("name", FAULTY)
def test_faults_of_fans_are_those_of_comparing_all(name):
    found = all_with_all(FAULTY[name])
    assert by_fans(FAULTY[name]) == found
    assert len(found) > 0 or name == "all in one line are no faces"


def test_equal_faces_meet_what_either_meets():
    pierced = FAULTY["ball through the side"]
    doubled = Mesh.of(pierced.vertices, np.vstack((pierced.faces, pierced.faces[:MORE], pierced.faces[:9, ::-1])))
    found = by_fans(doubled)
    assert found == all_with_all(doubled)
    assert len(found) > len(by_fans(pierced))


def test_a_face_there_a_thousand_times_takes_no_longer_for_it():
    mesh = cone(MORE)
    many = Mesh.of(mesh.vertices, np.vstack((mesh.faces, np.repeat(mesh.faces[:1], 1000, axis=0))))
    assert by_fans(many) == []


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), grid=st.sampled_from([3, 8, 1000]), wild=st.booleans())
def test_any_fan_is_judged_as_by_comparing_all(seed, grid, wild):
    """Faces around one place with other corners on a coarse grid, so that they lie in one plane or line, touch and cross."""
    random = np.random.default_rng(seed)
    points = random.integers(-grid, grid + 1, (30 if grid < 9 else 150, 3)).astype(float)
    points = np.unique(points[(points != 0).any(axis=1)], axis=0) * (np.pi / 3.0 if wild else 1.0)
    corners = np.array([random.choice(len(points), 2, replace=False) for _ in range(MANY_FACES + 30)]) + 1
    others = np.array([random.choice(len(points), 3, replace=False) for _ in range(10)]) + 1
    faces = np.vstack((np.column_stack((np.zeros(len(corners), int), corners)), others))
    mesh = Mesh.of(np.vstack((np.zeros(3), points)), faces)
    places = np.sort(position_ids(mesh.vertices)[mesh.faces], axis=1)
    mesh = Mesh.of(mesh.vertices, mesh.faces[np.unique(places, axis=0, return_index=True)[1]])  # equal faces are not its task
    assert by_fans(mesh) == all_with_all(mesh)


def test_the_work_grows_with_the_faces_not_with_their_square():
    """Four times the faces at a tip: four times the time and a little, where comparing all would take sixteen times as long."""
    find_intersecting_faces(cone(MORE).vertices, cone(MORE).faces)  # compiles
    seconds = []
    for count in (2_000, 8_000):
        mesh = turned(cone(count))
        start = time.process_time()
        assert len(find_intersecting_faces(mesh.vertices, mesh.faces)) == 0
        seconds.append(time.process_time() - start)
    assert seconds[1] < 8.0 * seconds[0]
