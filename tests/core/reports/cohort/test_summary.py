"""The summary of a cohort: numbers out of reports, table, page; what names try to be is text."""

from __future__ import annotations

import csv
import io
from typing import Any

from core.reports.cohort.numbers import numbers_of
from core.reports.cohort.page import render_page
from core.reports.cohort.summary import sentence, summarize_cohort, varying_columns
from core.reports.cohort.table import render_table
from core.schema.cohort import CohortSummary, CohortSummaryInputs, EndedSubject

REPORT: dict[str, Any] = {
    "meshes": {
        "skin": {"faces": 100, "genus": 0, "closed": True, "volume_mm3": 5.5, "quality": {"minimum": 0.1}},
        "fat": {"faces": 90, "genus": None, "volume_mm3": None, "quality": {"minimum": 0.2}},
    },
    "pairs": [{"a": "skin", "b": "fat", "intersecting_pairs": 0, "min_gap_mm": 0.05}],
    "thickness": {"fat": {"on_target_area": 0.99, "limited_area": 0.01, "missed_area": 0.0, "min_mm": 0.9}},
    "comparisons": {"skin": {"deviation": {"maximum_mm": 0.3}, "volume_change": -0.01}},
    "regions": {"fat": {"tetrahedra": 12, "quality_minimum": 0.3}},
    "steps": [{"name": "heal", "numbers": {"holes": 3, "by": "hand"}}],
    "findings": [{"severity": "warning"}, {"severity": "info"}],
}


def subject(name: str, status: Any = "successful", verdict: Any = "simulation_ready", **more: Any) -> EndedSubject:
    return EndedSubject(subject=name, status=status, verdict=verdict if status == "successful" else None, **more)


def summary_of(volumes: dict[str, float], *others: EndedSubject) -> CohortSummary:
    inputs = CohortSummaryInputs(process="shells", name="Pilot", subjects=(*map(subject, volumes), *others))
    return summarize_cohort(inputs, {name: {"skin.volume_mm3": volume, "errors": 0} for name, volume in volumes.items()})


VOLUMES = {"a": 1.0, "b": 1.1, "c": 0.9, "d": 1.05, "e": 0.95, "giant": 50.0}


def test_numbers_come_from_everywhere_in_the_report() -> None:
    assert numbers_of(REPORT) == {
        "skin.faces": 100,
        "skin.genus": 0,
        "skin.volume_mm3": 5.5,
        "skin.quality_minimum": 0.1,
        "fat.faces": 90,
        "fat.quality_minimum": 0.2,
        "skin-fat.intersecting_pairs": 0,
        "skin-fat.min_gap_mm": 0.05,
        "fat.on_target_area": 0.99,
        "fat.limited_area": 0.01,
        "fat.missed_area": 0.0,
        "fat.min_mm": 0.9,
        "skin.deviation_mm": 0.3,
        "skin.volume_change": -0.01,
        "fat.tetrahedra": 12,
        "heal: holes": 3,
        "errors": 0,
        "warnings": 1,
    } | {"fat.quality_minimum": 0.3}


def test_a_single_surface_is_compared_whatever_its_upload_was_called() -> None:
    for name in ("anna", "bert"):
        assert numbers_of({"meshes": {name: {"faces": 7}}})["mesh.faces"] == 7


def test_what_is_no_number_is_left_out() -> None:
    odd = {
        "meshes": {"a": {"faces": True, "genus": float("nan"), "area_mm2": "12", "quality": 3}},
        "thickness": [1],
        "steps": None,
    }
    assert numbers_of(odd) == {"errors": 0, "warnings": 0}
    assert len(numbers_of({"meshes": {f"m{number}": {"faces": 1} for number in range(1000)}})) == 200


def test_every_end_is_counted_and_the_giant_is_marked() -> None:
    told = summary_of(
        VOLUMES,
        subject("f", "failed", code="skin.not_closed", message="3 open edges"),
        subject("x", "refused"),
        subject("y", "dismissed"),
        subject("z", verdict="not_ready"),
    )
    assert (told.subjects, told.ready, told.not_ready, told.failed, told.dismissed, told.refused) == (10, 6, 1, 1, 1, 1)
    assert [(outlier.subject, outlier.column) for outlier in told.outliers] == [("giant", "skin.volume_mm3")]
    assert sentence(told) == (
        "6 of 10 subjects are simulation ready, 1 not ready, 1 failed, 1 dismissed, 1 refused, "
        "1 with numbers far from the others'."
    )


def test_a_failed_job_shows_its_numbers_and_sets_no_measure() -> None:
    inputs = CohortSummaryInputs(process="shells", subjects=(subject("a"), subject("b", "failed")))
    told = summarize_cohort(inputs, {"a": {"n": 1.0}, "b": {"n": 9.0}})
    assert (told.columns["n"].count, told.columns["n"].maximum, told.rows[1].numbers) == (1, 1.0, {"n": 9.0})


def test_the_table_can_be_read_back_and_holds_no_formula() -> None:
    told = summary_of(VOLUMES, subject('=HYPERLINK("x")', "failed", code="a.b", message="-1, or\nmore"))
    rows = list(csv.DictReader(io.StringIO(render_table(told))))
    assert [float(row["skin.volume_mm3"]) for row in rows[:-1]] == list(VOLUMES.values())
    assert [row["outliers"] for row in rows] == ["", "", "", "", "", "skin.volume_mm3", ""]
    assert (rows[-1]["subject"], rows[-1]["message"], rows[-1]["skin.volume_mm3"]) == ('\'=HYPERLINK("x")', "'-1, or\nmore", "")


def test_the_page_shows_what_is_far_and_what_failed_as_text() -> None:
    evil = "<script>alert(1)</script>"
    told = summary_of(VOLUMES, subject(evil, "failed", code="skin.not_closed", message="<img src=x>"))
    page = render_page(told)
    assert page == render_page(told)
    assert evil not in page
    assert "&lt;script&gt;" in page
    assert "<img" not in page
    assert 'class="far"' in page
    assert "▲ 0.05" in page  # cm³
    assert page.count("<tr><th>") >= 7
    assert "://" not in page


def test_nothing_but_refused_subjects_is_a_summary_too() -> None:
    told = summary_of({}, subject("x", "refused", code="format.unknown", message="no mesh"))
    assert (told.columns, told.outliers) == ({}, ())
    assert "format.unknown" in render_page(told)
    assert len(render_table(told).splitlines()) == 2


def test_what_is_the_same_for_all_takes_no_column_of_the_table_of_subjects() -> None:
    told = summary_of(VOLUMES, subject("lost", "failed", code="skin.not_closed", message="3 open edges"))
    assert varying_columns(told.rows) == ["skin.volume_mm3"]
    page = render_page(told)
    assert page.count("<th>errors</th>") == 1, "in the table of what is usual"
    assert page.count("<th>skin volume [cm³]</th>") == 3, "there, and among the subjects on the screen and on paper"


def test_the_page_is_headed_by_how_many_are_ready_and_shows_volumes_as_people_read_them() -> None:
    failed = subject("late", "failed", code="skin.too_thin", message="at 26756 faces it is too thin")
    page = render_page(summary_of({name: 41_624_292.0 * share for name, share in VOLUMES.items()}, failed))
    assert "Pilot: 6 of 7 ready" in page
    assert "skin volume [cm³]" in page
    assert "41\u202f624" in page
    assert "41\u202f624\u202f292" not in page
    assert "At 26\u202f756 faces it is too thin" in page


def test_on_paper_no_table_of_subjects_is_wider_than_the_sheet() -> None:
    inputs = CohortSummaryInputs(process="shells", name="Wide", subjects=tuple(map(subject, VOLUMES)))
    numbers = {name: {f"n{column}": volume + column for column in range(20)} for name, volume in VOLUMES.items()}
    page = render_page(summarize_cohort(inputs, numbers))
    papers = [part.split("</table>")[0] for part in page.split('<div class="on-paper">')[1:]]
    heads = [part.split("</thead>")[0].count("<th>") for part in papers]
    assert heads == [8, 8, 7]  # the subject, and 20 numbers in all
    assert all(f"<th>{name}</th>" in part for part in papers for name in VOLUMES)
    same = render_page(summarize_cohort(inputs, {name: {"errors": 0} for name in VOLUMES}))
    assert same.count('<div class="on-paper">') == 1
