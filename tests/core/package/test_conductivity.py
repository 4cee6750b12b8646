"""Defaults by tolerant names."""

import pytest

from core.package.conductivity import conductivity_of, look_up


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
