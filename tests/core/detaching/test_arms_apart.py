"""Boxes for lowered arms on a body whose arms are apart: refused by name, whatever narrow place is in the box."""

import pytest

from core.detaching.detach import detach
from core.errors import InputError
from core.schema.detach import ContactRegion, DetachSettings
from subjects.body import body

ARMPIT = {"name": "left_arm", "box_mm": {"min": [60, 330, -60], "max": [240, 450, 90]}}


def test_what_does_not_touch_is_refused_by_name() -> None:
    with pytest.raises(InputError) as refused:
        detach(body(0), DetachSettings(regions=(ContactRegion.model_validate(ARMPIT),)))
    assert refused.value.code == "detach.no_room"
    assert "no contact" in str(refused.value)
