"""Contacts with known areas opened, and what cannot be opened refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from core.detaching.detach import Detached, detach
from core.errors import InputError
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.quality import quality
from core.mesh import Mesh
from core.schema.detach import DetachSettings
from core.schema.finding import Severity
from core.validation.validate import validate
from subjects.touching import balls_grown_together, closed_ring, crossing_ring
from tests.solids import sphere

RADIUS_MM, APART_MM = 30.0, 50.0
DISC_MM2 = np.pi * (RADIUS_MM**2 - (APART_MM / 2) ** 2)
BALLS_BOX = {"min": [-40, -40, -40], "max": [90, 40, 40]}


def settings(box: dict[str, list[float]], contacts: int = 1, **others: Any) -> DetachSettings:
    return DetachSettings.model_validate({"regions": [{"name": "contact", "box_mm": box, "contacts": contacts}], **others})


def opened(mesh: Mesh, box: dict[str, list[float]], **others: Any) -> Detached:
    result = detach(mesh, settings(box, **others))
    errors = [finding for finding in validate({"skin": result.mesh}).findings if finding.severity is Severity.ERROR]
    assert errors == []
    return result


def changed_reach_out(before: Mesh, after: Mesh, box: dict[str, list[float]]) -> bool:
    """Places of corners of faces that only one of the two has, told apart from those of both, independently of the proof."""
    keys = [{tuple(sorted(map(tuple, face))) for face in mesh.triangles().tolist()} for mesh in (before, after)]
    corners = np.array([corner for face in keys[0] ^ keys[1] for corner in face])
    return bool(((corners <= box["min"]) | (corners >= box["max"])).any())


@pytest.mark.parametrize("gap_mm", [0.3, 2.0])
def test_balls_come_apart_along_the_disc_they_share(gap_mm: float) -> None:
    mesh = balls_grown_together(RADIUS_MM, APART_MM)
    result = opened(mesh, BALLS_BOX, pieces=2, gap_mm=gap_mm)
    (contact,) = result.contacts
    assert result.pieces == 2
    assert contact.area_mm2 == pytest.approx(DISC_MM2, rel=0.06)
    assert gap_mm <= contact.gap_mm <= 1.25 * gap_mm
    assert contact.end_mm == 0.0
    assert np.allclose(contact.point_mm, (APART_MM / 2, 0, 0), atol=4.0)
    assert DISC_MM2 * gap_mm * 0.9 < contact.volume_mm3 < DISC_MM2 * (gap_mm + 1.0) * 1.3
    # the two stay apart on both sides of the plane that was the contact
    left = result.mesh.vertices[:, 0] < APART_MM / 2
    assert not (left[result.mesh.faces].any(axis=1) & ~left[result.mesh.faces].all(axis=1)).any()
    assert quality(result.mesh.vertices, result.mesh.faces[result.new]).min() > 0.3


def test_ends_that_run_into_each_other_are_united_and_come_apart() -> None:
    mesh = crossing_ring(6.0)
    box = {"min": [20.0, -30.0, -15.0], "max": [60.0, 30.0, 15.0]}
    assert len(find_intersecting_faces(mesh.vertices, mesh.faces)) > 0
    result = opened(mesh, box)
    (contact,) = result.contacts
    assert len(result.crossing) > 0
    assert contact.area_mm2 == pytest.approx(np.pi * (10.0**2 - 7.0**2), rel=0.15)
    assert (contact.genus_before, contact.genus_after) == (1, 0)
    assert contact.gap_mm >= 1.0
    assert not changed_reach_out(mesh, result.mesh, box)
    assert len(opened(closed_ring(4.0), box).crossing) == 0


@pytest.mark.parametrize("apart_mm", [40.0, 30.0])
def test_balls_sunk_into_each_other_up_to_their_radius_come_apart_along_their_disc(apart_mm: float) -> None:
    result = opened(balls_grown_together(RADIUS_MM, apart_mm), BALLS_BOX, pieces=2)
    (contact,) = result.contacts
    assert contact.area_mm2 == pytest.approx(np.pi * (RADIUS_MM**2 - (apart_mm / 2) ** 2), rel=0.01)
    assert np.allclose(contact.middle_mm, (apart_mm / 2, 0, 0), atol=0.3)
    assert abs(contact.normal[0]) > 0.999
    assert 1.0 <= contact.gap_mm < 1.2


def test_a_waist_without_a_crease_is_no_deep_contact() -> None:
    ball = sphere(30.0, 4)
    along = ball.vertices[:, 0] / 30.0
    slender = 1.0 - 0.12 * np.exp(-((along / 0.25) ** 2))  # where a creased one of 0.88 would be opened
    peanut = ball.with_vertices(ball.vertices * np.column_stack((np.full(len(along), 2.0), slender, slender)))
    with pytest.raises(InputError) as refused:
        detach(peanut.rounded_to_float32(), settings({"min": [-70, -40, -40], "max": [70, 40, 40]}))
    assert refused.value.code == "detach.no_contact"


def test_a_ring_becomes_a_sausage_and_nothing_outside_of_the_box_changes() -> None:
    mesh, box = closed_ring(4.0), {"min": [20, -30, -15], "max": [60, 30, 15]}
    result = opened(mesh, box)
    (contact,) = result.contacts
    assert (contact.genus_before, contact.genus_after, result.pieces) == (1, 0, 1)
    assert contact.area_mm2 == pytest.approx(np.pi * (10.0**2 - 8.0**2), rel=0.08)
    assert not changed_reach_out(mesh, result.mesh, box)
    assert len(mesh.faces) - contact.faces_removed == np.count_nonzero(~result.new)


def test_a_box_that_ends_in_the_contact_gives_a_slit_that_ends_in_the_body() -> None:
    mesh, box = balls_grown_together(RADIUS_MM, APART_MM), {"min": [-40, -40, 3], "max": [90, 40, 40]}
    result = opened(mesh, box)
    (contact,) = result.contacts
    assert contact.end_mm > 20.0
    assert contact.area_mm2 < 0.5 * DISC_MM2
    assert contact.gap_mm >= 1.0
    assert not changed_reach_out(mesh, result.mesh, box)


def test_the_same_twice_is_the_same() -> None:
    mesh, asked = closed_ring(4.0), settings({"min": [20, -30, -15], "max": [60, 30, 15]})
    first, second = detach(mesh, asked).mesh, detach(mesh, asked).mesh
    assert np.array_equal(first.vertices, second.vertices)
    assert np.array_equal(first.faces, second.faces)


BALLS = balls_grown_together(RADIUS_MM, APART_MM)
REFUSALS = {
    "one ball has no contact": (sphere(30.0, 4), {"min": [-40, -40, -40], "max": [40, 40, 40]}, {}, "detach.no_contact"),
    "a box in the air": (BALLS, {"min": [200, 0, 0], "max": [210, 10, 10]}, {}, "region.outside_mesh"),
    "a box within the body": (BALLS, {"min": [-5, -5, -5], "max": [5, 5, 5]}, {}, "detach.no_contact"),
    "more contacts wanted": (BALLS, BALLS_BOX, {"contacts": 2}, "detach.not_one_contact"),
    "one piece wanted, two made": (BALLS, BALLS_BOX, {"pieces": 1}, "detach.region_cuts_too_much"),
    "three pieces wanted, two made": (BALLS, BALLS_BOX, {"pieces": 3}, "detach.still_attached"),
    "contact too large": (BALLS, BALLS_BOX, {"max_contact_cm2": 5.0}, "detach.region_cuts_too_much"),
    "swallowed": (balls_grown_together(30.0, 24.0), BALLS_BOX, {}, "detach.no_contact"),
    "no room in the box": (BALLS, {"min": [-40, -40, -0.4], "max": [90, 40, 0.4]}, {}, "detach.no_room"),
}


@pytest.mark.parametrize("name", REFUSALS)
def test_what_cannot_be_opened_is_refused_by_name_with_a_place(name: str) -> None:
    mesh, box, others, code = REFUSALS[name]
    with pytest.raises(InputError) as refused:
        detach(mesh, settings(box, **others))
    assert refused.value.code == code
    assert code == "region.outside_mesh" or refused.value.findings[0].places
