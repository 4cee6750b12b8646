"""Arms of the real body off its torso, at full length: minutes where many jobs share a processor."""

import numpy as np
import pytest

from core.detaching.detach import detach
from core.schema.detach import DetachSettings
from subjects.touching import arms_lowered, grown_together
from subjects.trial import READY, attempt

pytestmark = pytest.mark.slow
ARMS = [
    {"name": "left", "box_mm": {"min": [60, 310, -60], "max": [240, 445, 90]}},
    {"name": "right", "box_mm": {"min": [-240, 310, -60], "max": [-60, 445, 90]}},
]


def test_both_arms_come_off_and_shells_can_be_made() -> None:
    skin = grown_together(arms_lowered(42.0))
    result = detach(skin, DetachSettings.model_validate({"regions": ARMS}))
    assert [contact.region for contact in result.contacts] == ["left", "right"]
    for contact in result.contacts:
        assert 3000.0 < contact.area_mm2 < 3800.0
        assert 1.0 <= contact.gap_mm < 2.0
        assert 0.8 < contact.volume_mm3 / (contact.area_mm2 * contact.gap_mm) < 2.0
    x, y = np.abs(skin.vertices[:, 0]), skin.vertices[:, 1]
    kept = {place.tobytes() for place in result.mesh.vertices + 0.0}
    away = (y < 300.0) | (y > 455.0) | (x < 50.0)
    assert all(place.tobytes() in kept for place in skin.vertices[away] + 0.0)
    trial = attempt(result.mesh, (1.0, 3.0))
    assert (trial.outcome, trial.broken) == (READY, ())
