"""Arms of the real body off its torso, at full length: minutes where many jobs share a processor."""

import numpy as np
import pytest

from core.detaching.detach import detach
from core.schema.detach import DetachSettings
from subjects.people import person
from subjects.touching import arms_lowered, feet_turned_in, grown_together, legs_closed
from subjects.trial import READY, attempt

pytestmark = pytest.mark.slow
ARMS = [
    {"name": "left", "box_mm": {"min": [60, 310, -60], "max": [240, 445, 90]}},
    {"name": "right", "box_mm": {"min": [-240, 310, -60], "max": [-60, 445, 90]}},
]


@pytest.mark.parametrize("is_united", [True, False])
def test_both_arms_come_off_and_shells_can_be_made(is_united: bool) -> None:
    skin = grown_together(arms_lowered(42.0)) if is_united else person(turns=arms_lowered(42.0)).rounded_to_float32()
    result = detach(skin, DetachSettings.model_validate({"regions": ARMS}))
    assert [contact.region for contact in result.contacts] == ["left", "right"]
    for contact in result.contacts:
        assert 2700.0 < contact.area_mm2 < 3800.0
        assert 1.0 <= contact.gap_mm < 2.0
        assert 0.8 < contact.volume_mm3 / (contact.area_mm2 * contact.gap_mm) < 2.0
    x, y = np.abs(skin.vertices[:, 0]), skin.vertices[:, 1]
    kept = {place.tobytes() for place in result.mesh.vertices + 0.0}
    away = (y < 300.0) | (y > 480.0) | (x < 50.0)
    assert all(place.tobytes() in kept for place in skin.vertices[away] + 0.0)
    trial = attempt(result.mesh, (1.0, 3.0))
    assert (trial.outcome, trial.broken) == (READY, ())


THIGHS = {"name": "thighs", "box_mm": {"min": [-110, -480, -130], "max": [110, -60, 150]}}
FEET = {"name": "feet", "box_mm": {"min": [-130, -900, -140], "max": [130, -700, 200]}}


def test_thighs_that_share_their_length_come_apart_in_the_middle() -> None:
    result = detach(grown_together(legs_closed(17.0)), DetachSettings.model_validate({"regions": [THIGHS]}))
    (contact,) = result.contacts
    assert 19_000.0 < contact.area_mm2 < 23_000.0
    assert abs(contact.middle_mm[0]) < 0.5
    assert abs(contact.normal[0]) > 0.999
    assert contact.gap_mm >= 1.0
    assert (contact.genus_before, contact.genus_after) == (1, 0)


def test_feet_deep_in_one_another_are_cut_along_their_creases() -> None:
    result = detach(grown_together(feet_turned_in(13.0)), DetachSettings.model_validate({"regions": [FEET]}))
    (contact,) = result.contacts
    assert contact.area_mm2 > 3300.0  # what they share; the front of one foot would be less
    assert abs(contact.middle_mm[0]) < 4.0
    assert abs(contact.normal[0]) > 0.97
    assert contact.gap_mm >= 1.0
