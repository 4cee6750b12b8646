"""Generated canals: solids of the length, width and bend asked for."""

import numpy as np
import pytest

from core.ears.canal import make_canal
from core.validation.validate import validate


@pytest.mark.parametrize("bend", [0.0, 2.0, 5.0])
@pytest.mark.parametrize("radius", [2.0, 3.5])
def test_a_canal_is_a_good_solid(radius, bend):
    canal = make_canal((10, 20, 30), (-1, 0, 0.2), (0, 1, 0), radius_mm=radius, bend_mm=bend)
    checked = validate({"canal": canal})
    assert checked.verdict == "simulation_ready"
    report = checked.meshes["canal"]
    assert (report.genus, report.components, report.oriented_outward) == (0, 1, True)
    assert report.quality.minimum > 0.3


def test_length_width_and_swing():
    canal = make_canal((0, 0, 0), (1, 0, 0), (0, 1, 0), radius_mm=3.0, length_mm=30.0, bend_mm=3.0, outside_mm=4.0)
    low, high = canal.vertices.min(axis=0), canal.vertices.max(axis=0)
    assert low[0] == pytest.approx(-4.0, abs=0.3)
    assert high[0] == pytest.approx(30.0, abs=0.3)
    assert high[2] - low[2] == pytest.approx(6.0, abs=0.1)
    # first towards `up`, then the other way: an S
    middle = [canal.vertices[np.abs(canal.vertices[:, 0] - x) < 1.0, 1].mean() for x in (8.0, 22.0)]
    assert middle[0] > 0.5
    assert middle[1] < -1.0


def test_a_bend_that_cannot_be_is_an_error():
    with pytest.raises(ValueError, match="cannot bend"):
        make_canal((0, 0, 0), (1, 0, 0), (0, 1, 0), length_mm=20.0, bend_mm=8.0)
