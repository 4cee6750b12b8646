"""Defaults by tolerant names."""

import pytest

from core.errors import InputError
from core.package.conductivity import conductivities, conductivity_of, look_up


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("skin", 0.465),
        ("Scalp", 0.465),
        ("fat", 0.078),
        ("average_body", 0.16),
        ("Average Body", 0.16),
        ("averageBody", 0.16),
        ("muscle", 0.16),
        ("skull", 0.010),
        ("CSF", 1.654),
        ("grey-matter", 0.275),
        ("GM", 0.275),
        ("white_matter", 0.126),
        ("cartilage", 0.88),
    ],
)
def test_known_tissues(name, value):
    assert conductivity_of(name) == value
    assert look_up(name).known
    assert "SimNIBS" in look_up(name).source


def test_unknown_names_say_so():
    found = look_up("outer_layer_7")
    assert not found.known
    assert found.siemens_per_metre == 0.16
    assert found.source.startswith("no default for this name")


def test_the_callers_own_comes_before_that_of_the_package_and_that_before_the_default():
    assert conductivities(["skin", "fat", "csf"], {"skin": 0.4}, {"skin": 0.3, "fat": 0.05}) == {
        "skin": 0.4,
        "fat": 0.05,
        "csf": 1.654,
    }


def test_a_tissue_that_is_not_there_is_refused_by_name():
    with pytest.raises(InputError, match=r"bone.*the tissues are skin, fat") as error:
        conductivities(["skin", "fat"], {"bone": 0.01})
    assert error.value.code == "conductivity.unknown_tissue"
