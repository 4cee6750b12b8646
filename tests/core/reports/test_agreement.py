"""Every number in the tables of a real report is that of report.json, to the last digit shown."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from core.reports.tissue_rows import tissue_rows
from core.schema.report import Report
from tests.core.processes.test_surface_processes import executed, href, stored
from tests.solids import sphere

NUMBER = re.compile(r"([−+-]?[\d\u202f]+(?:\.(\d+))?(?:e([−+]?\d+))?)\s*(m²|cm²|l\b|cm³|%)?")
FACTORS = {"m²": 1e6, "cm²": 1e2, "l": 1e6, "cm³": 1e3, "%": 1e-2}
NOT_KNOWN = "–"


class Tables(HTMLParser):
    """Cells of every table by the heading above it: heading -> tables -> rows -> texts."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: dict[str, list[list[list[str]]]] = {}
        self._heading, self._into = "", ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Headings, tables, rows and cells of their bodies."""
        if tag == "h2":
            self._heading, self._into = "", "heading"
        elif tag == "table":
            self.found.setdefault(self._heading, []).append([])
        elif tag == "tr" and self.found.get(self._heading):
            self.found[self._heading][-1].append([])
        elif tag in ("td", "th") and self.found.get(self._heading):
            self.found[self._heading][-1][-1].append("")
            self._into = "cell"

    def handle_endtag(self, tag: str) -> None:
        """Text between cells is nobody's."""
        if tag in ("h2", "td", "th"):
            self._into = ""

    def handle_data(self, data: str) -> None:
        """Into the heading or cell that is open."""
        if self._into == "heading":
            self._heading += data
        elif self._into == "cell":
            self.found[self._heading][-1][-1][-1] += data

    def rows(self, heading: str, number: int = 0) -> dict[str, list[str]]:
        """Name in front -> the cells behind it."""
        return {cells[0].strip(): cells[1:] for cells in self.found[heading][number] if len(cells) > 1}


def read(text: str) -> Iterator[tuple[float, float]]:
    """(value, half of the last digit shown) of each number in a cell, in mm, mm², mm³ and shares."""
    for found in NUMBER.finditer(text):
        digits = found[1].replace("\u202f", "").replace("−", "-")
        power = int((found[3] or "0").replace("−", "-")) - len(found[2] or "")
        factor = FACTORS.get(found[4] or "", 1.0)
        yield float(digits) * factor, 0.5 * 10.0**power * factor


def agrees(text: str, *expected: float | int | None) -> int:
    """How many numbers were compared."""
    known = [value for value in expected if value is not None]
    if not known:
        assert text.strip().startswith(NOT_KNOWN), text
        return 0
    shown = list(read(text))
    assert len(shown) >= len(known), (text, expected)
    for value, (told, tolerance) in zip(known, shown, strict=False):
        assert abs(told - value) <= 1.001 * tolerance, (text, value)
    return len(known)


Done = tuple[Report, Tables]


@pytest.fixture(scope="module")
def layered(tmp_path_factory: pytest.TempPathFactory) -> Done:
    return report_of("shells", tmp_path_factory.mktemp("shells"), {
        "skin": {"href": href(0)}, "layers": [{"name": "fat", "depth_mm": 1.0}, {"name": "inner", "depth_mm": 3.0}],
    })  # fmt: skip


@pytest.fixture(scope="module")
def thinned(tmp_path_factory: pytest.TempPathFactory) -> Done:
    return report_of("decimate", tmp_path_factory.mktemp("decimate"), {"mesh": {"href": href(0)}, "target_faces": 300})


def report_of(process: str, folder: Path, inputs: dict[str, Any]) -> Done:
    files = executed(process, folder, inputs, stored(folder, {"ball": sphere(40.0, 3)}))["files"]
    report = Report.model_validate_json(files["report"].read_text(encoding="utf-8"))
    return report, Tables(files["report_html"].read_text(encoding="utf-8"))


def test_the_table_of_tissues(layered: Done) -> None:
    report, tables = layered
    compared = 0
    for row in tissue_rows(report):
        cells, depth = tables.rows("Tissues")[row.name], report.thickness.get(row.name)
        mesh = report.meshes[row.name]
        expected: list[tuple[float | None, ...]] = [(mesh.faces,), (mesh.area_mm2,), (mesh.volume_mm3,)]
        if depth is None:
            expected += [(None,)] * 4
        else:
            expected += [(depth.target_mm,), (depth.percentiles_mm["50"],), (depth.on_target_area,)]
            expected += [(depth.limited_area, depth.missed_area)]
        gaps = [pair.min_gap_mm for pair in report.pairs if row.name in (pair.a, pair.b) and pair.min_gap_mm is not None]
        crossing = sum(pair.intersecting_pairs for pair in report.pairs if row.name in (pair.a, pair.b))
        expected += [(mesh.self_intersecting_pairs + crossing,), (min(gaps),), (mesh.quality.minimum,)]
        compared += sum(agrees(text, *values) for text, values in zip(cells, expected, strict=True))
    assert compared == 3 * 6 + 2 * 5


def test_the_table_of_depths(layered: Done) -> None:
    report, tables = layered
    for name, layer in report.thickness.items():
        shares = [layer.percentiles_mm[share] for share in ("1", "5", "25", "50", "75", "95", "99")]
        values = [
            layer.target_mm,
            layer.on_target_area,
            layer.limited_area,
            layer.missed_area,
            layer.min_mm,
            *shares,
            layer.max_mm,
        ]
        cells = tables.rows("Depth of the layers")[name]
        assert sum(agrees(text, value) for text, value in zip(cells, values, strict=True)) == 13


def test_the_table_of_pairs(layered: Done) -> None:
    report, tables = layered
    for pair in report.pairs:
        _relation, gap, at, crossing = tables.rows("Against each other")[f"{pair.a}, {pair.b}"]
        assert agrees(gap, pair.min_gap_mm) == agrees(crossing, pair.intersecting_pairs) == 1
        assert agrees(at, *(pair.min_gap_point_mm or ())) == 3


def test_the_tables_of_every_surface(layered: Done) -> None:
    report, tables = layered
    for name, mesh in report.meshes.items():
        topology = tables.rows("Every surface")[name]
        flags = [mesh.closed, mesh.edge_manifold, mesh.vertex_manifold, mesh.consistently_oriented, mesh.oriented_outward]
        assert topology[2:7] == ["yes" if flag else "no" for flag in flags]
        counts = [mesh.components, mesh.genus, mesh.degenerate_faces, mesh.duplicate_faces, mesh.self_intersecting_pairs]
        assert sum(agrees(text, count) for text, count in zip([*topology[:2], *topology[7:]], counts, strict=True)) == 5
        shape = tables.rows("Every surface", 1)[name]
        edges, q = mesh.edges, mesh.quality
        values = [(mesh.vertices,), (mesh.faces,), mesh.extents_mm, (edges.minimum_mm,), (edges.median_mm,), (edges.maximum_mm,)]
        values += [(mesh.minimum_dihedral_deg,), (q.minimum,), (q.percentile_1,), (q.median,), (q.mean,)]
        assert sum(agrees(text, *told) for text, told in zip(shape, values, strict=True)) == 13


def test_the_table_of_before_and_after(thinned: Done) -> None:
    report, tables = thinned
    ((name, comparison),) = report.comparisons.items()
    before, after, deviation = comparison.before, report.meshes[name], comparison.deviation
    expected: list[tuple[float | None, ...]] = [
        (before.faces, after.faces),
        (comparison.kept_vertices,),
        (deviation.maximum_mm, deviation.rms_mm, *deviation.at_mm),
        (comparison.volume_change, comparison.area_change),
        (before.quality.minimum, after.quality.minimum, before.quality.mean, after.quality.mean),
        (before.self_intersecting_pairs, after.self_intersecting_pairs),
    ]
    cells = tables.rows("Before and after")[name]
    assert sum(agrees(text, *values) for text, values in zip(cells, expected, strict=True)) == 16


@pytest.mark.parametrize(("text", "value"), [("26\u202f756", 26757), ("1.6138 m²", 1.6139e6), ("99.86 %", 0.9987), ("−0.5", 0.5)])
def test_a_number_that_differs_in_the_last_digit_is_noticed(text: str, value: float) -> None:
    with pytest.raises(AssertionError):
        agrees(text, value)
