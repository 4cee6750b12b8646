"""Numbers as people read them, never better than they are."""

import pytest

from core.reports import wording
from core.schema.report import PairReport


@pytest.mark.parametrize(
    ("share", "words"),
    [(None, "–"), (0.0, "0 %"), (1.0, "100 %"), (0.99999, "99.99 %"), (0.000001, "0.01 %"), (0.98617, "98.62 %")],
)
def test_percent_is_never_rounded_to_all_or_nothing(share, words):
    assert wording.percent(share) == words


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "–"),
        (0.0, "0"),
        (0.05123, "0.0512"),
        (-12.34, "−12.3"),
        (107024.0, "107\u202f024"),
        (2.4e-5, "2.40e−05"),
        (1e9, "1.00e+09"),
    ],
)
def test_significant_digits_without_needless_exponents(value, words):
    assert wording.significant(value) == words


def test_areas_and_volumes_take_the_unit_that_fits():
    assert wording.area(1_613_800.0) == "1.6138 m²"
    assert wording.area(1234.0) == "12.34 cm²"
    assert wording.volume(54_895_000.0) == "54.895 l"
    assert wording.volume(4189.0) == "4.189 cm³"
    assert wording.volume(None) == "–"


def test_long_lists_are_cut():
    assert wording.numbers(tuple(range(15))) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 3 more"
    assert wording.numbers(()) == ""


def test_parameters_are_flattened_to_paths():
    parameters = {"layers": [{"name": "fat", "depth_mm": 1.0}], "box": {"min": [0, 1, 2]}, "regions": [], "note": None}
    assert wording.flattened(parameters) == [
        ("layers[0].name", "fat"),
        ("layers[0].depth_mm", "1"),
        ("box.min", "0, 1, 2"),
        ("regions", "–"),
        ("note", "–"),
    ]


def test_every_relation_has_words():
    words = {
        wording.relation(
            PairReport(a="A", b="B", relation=relation, intersecting_pairs=0, case_1=0, case_2=0, case_3=0, min_gap_mm=None)
        )
        for relation in ("a_inside_b", "b_inside_a", "disjoint", "intersecting", "undetermined")
    }
    assert len(words) == 5
    assert "A lies inside B" in words


@pytest.mark.parametrize(("mm", "words"), [(None, "–"), (1.3e-13, "0 mm"), (0.34567, "0.346 mm"), (-2.0, "−2 mm")])
def test_lengths_that_are_rounding_are_nothing(mm, words):
    assert wording.distance(mm) == words


def test_depths_of_a_column_have_as_many_digits():
    assert [wording.depth(mm) for mm in (1.0, 0.0766, None)] == ["1.000", "0.077", "–"]


@pytest.mark.parametrize(("share", "words"), [(0.0123, "+1.2 %"), (-3.06e-6, "−0.00031 %"), (9e-10, "0 %"), (None, "–")])
def test_drift_of_rounding_is_nothing(share, words):
    assert wording.drift(share) == words


def test_codes_are_made_readable():
    assert wording.title_of("shells.depth_missed") == "Shells: depth missed"


def test_large_and_negative_numbers_look_alike_in_every_column():
    assert (wording.significant(8460.0, 4), wording.whole(8460)) == ("8\u202f460", "8\u202f460")
    assert (wording.significant(-1452.0, 4), wording.whole(-86095)) == ("−1\u202f452", "−86\u202f095")
    assert wording.significant(512.0) == "512"
