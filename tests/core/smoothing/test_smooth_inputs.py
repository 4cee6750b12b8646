"""Contradictions are refused before anything is computed."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from core.schema.smooth import SmoothInputs

UPLOAD = {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}
BOX = {"min": (0, 0, 0), "max": (1, 1, 1)}


@pytest.mark.parametrize(
    ("wanted", "reason"),
    [
        ({"method": "hc", "weight": 0.5}, "weight belongs to standard and lumped and cvt and wcc"),
        ({"method": "standard", "equal_weights": True}, "equal_weights belongs to cvt and wcc"),
        ({"method": "taubin", "hc_beta": 0.7}, "hc_beta belongs to hc"),
        ({"method": "cvt", "taubin_mu": -0.6}, "taubin_mu belongs to taubin"),
        ({"method": "taubin", "taubin_lambda": 0.6}, "must step out farther"),
        ({"method": "hc", "hc_beta": 0.4}, "greater than 0.5"),
        ({"method": "umbrella"}, "standard"),
        ({"iterations": 0}, "greater than or equal to 1"),
        ({"weight": 0.0}, "greater than 0"),
        ({"max_shift_mm": -1.0}, "greater than 0"),
        ({"regions": [{"name": "a", "box_mm": BOX}, {"name": "a", "box_mm": BOX}]}, "different names"),
        ({"regions": [{"name": "a", "box_mm": {"min": (0, 0, 0), "max": (0, 1, 1)}}]}, "below max"),
        ({"strength": 3}, "Extra inputs"),
    ],
)
def test_contradictions_are_refused(wanted, reason):
    with pytest.raises(ValidationError, match=reason):
        SmoothInputs(mesh=UPLOAD, **wanted)


@pytest.mark.parametrize("method", ["standard", "lumped", "cvt", "wcc", "hc", "taubin"])
def test_stored_inputs_are_read_again(method):
    inputs = SmoothInputs(mesh=UPLOAD, method=method)
    assert SmoothInputs.model_validate_json(inputs.model_dump_json()) == inputs
