"""`separate` as a process: package, report, figures; refusals with a report."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.package.read import read_package
from tests.core.processes.test_surface_processes import executed, href, of_package, stored
from tests.solids import sphere

MESHES = {
    "skin": sphere(10.0, 3),
    "left": sphere(4.0, 3, at=(-3.9, 0.1, 0.0)),
    "right": sphere(4.0, 3, at=(3.9, 0.0, 0.1)),
}


def given(folder):
    return {"meshes": {name: {"href": href(number)} for number, name in enumerate(MESHES)}}, stored(folder, MESHES)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("separate")
    inputs, entries = given(folder)
    return executed("separate", folder, {**inputs, "fixed": ["skin"]}, entries)


def test_the_package_holds_tissues_that_are_apart(done):
    assert done["verdict"] == "simulation_ready"
    package = read_package(done["files"]["package"])
    assert list(package.surfaces) == list(MESHES)
    assert {tissue.name: tissue.enclosing_tissue for tissue in package.manifest.tissues} == {
        "skin": "FreeSpace",
        "left": "skin",
        "right": "skin",
    }
    (pair,) = [pair for pair in done["report"].pairs if {pair.a, pair.b} == {"left", "right"}]
    assert pair.min_gap_mm >= 0.1
    np.testing.assert_array_equal(package.surfaces["skin"].triangles(), MESHES["skin"].rounded_to_float32().triangles())


def test_the_report_has_a_row_per_tissue_and_places(done):
    overview, *places = done["report"].changes[-3:]
    rows = {row["tissue"]: row for row in overview["tissues"]}
    assert rows["skin"]["moved_vertices"] == 0
    assert rows["skin"]["may_move"] == "no"
    assert 0.0 < rows["left"]["mean_shift_mm"] <= rows["left"]["largest_shift_mm"] < 0.4
    assert [change["mesh"] for change in places] == ["left", "right"]
    point = np.array(places[0]["places"][0]["point_mm"])
    assert np.linalg.norm(point) < 2.0  # between the two balls
    page = done["files"]["report_html"].read_text(encoding="utf-8")
    assert "3 tissues" in page
    assert "gap opened" in page


def test_its_package_is_taken_again_and_nothing_moves(done, tmp_path):
    again = of_package("separate", tmp_path, done["files"]["package"])
    assert "Nothing had to move" in again["report"].summary


def test_a_refusal_leaves_a_report_with_the_places(tmp_path):
    inputs, entries = given(tmp_path)
    with pytest.raises(InputError) as error:
        executed("separate", tmp_path, {**inputs, "fixed": ["left", "right"]}, entries)
    assert error.value.code == "separate.no_room"
    assert {output["name"] for output in error.value.outputs} == {"report", "report_html"}
