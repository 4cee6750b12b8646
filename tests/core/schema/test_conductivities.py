"""Conductivities of a caller's own: what is absurd is refused before there is a job."""

import pytest
from pydantic import ValidationError

from core.schema.processes import PROCESSES

MESH = {"href": "/v1/meshes/00000000-0000-0000-0000-000000000001"}
SUBJECTS = {
    "heal": {"mesh": MESH},
    "decimate": {"mesh": MESH, "target_ratio": 0.5},
    "smooth": {"mesh": MESH},
    "separate": {"meshes": {"skin": MESH, "fat": MESH}},
    "tetrahedralize": {"mesh": MESH},
    "segment": {"volume": MESH},
    "shells": {"skin": MESH},
    "ears": {"skin": MESH},
    "prepare": {"skin": MESH},
}


def asked(process: str, conductivities: dict[str, float], **more: object) -> object:
    return PROCESSES[process].inputs.model_validate(SUBJECTS[process] | {"conductivities_s_per_m": conductivities} | more)


@pytest.mark.parametrize("process", SUBJECTS)
@pytest.mark.parametrize("value", [-0.1, float("nan"), float("inf"), 1.1e8, "much"])
def test_absurd_values_are_refused_by_the_name_of_the_tissue(process, value):
    with pytest.raises(ValidationError) as error:
        asked(process, {"skin": value})
    assert error.value.errors()[0]["loc"] == ("conductivities_s_per_m", "skin")


@pytest.mark.parametrize("process", SUBJECTS)
def test_insulators_and_metals_are_taken(process):
    assert asked(process, {"skin": 0.0}).conductivities_s_per_m == {"skin": 0.0}
    assert asked(process, {"skin": 6e7}).conductivities_s_per_m == {"skin": 6e7}


@pytest.mark.parametrize("process", ["shells", "ears", "prepare"])
def test_names_that_are_no_layer_are_refused_at_once(process):
    with pytest.raises(ValidationError, match="names bone, the tissues are skin, fat, average_body"):
        asked(process, {"bone": 0.01})


def test_prepare_is_told_once():
    tissue = {"name": "bone", "mesh": MESH, "conductivity_s_per_m": 0.02}
    assert asked("prepare", {"skin": 0.4}, tissues=[tissue])
    with pytest.raises(ValidationError, match="both give that of bone"):
        asked("prepare", {"bone": 0.01}, tissues=[tissue])
