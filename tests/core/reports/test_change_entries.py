"""Changes on the page: readable whatever an algorithm puts into them."""

from core.reports.change_entries import MOST_ROWS, change_entries


def test_a_sentence_numbers_and_a_table() -> None:
    change = {
        "mesh": "skin",
        "kind": "holes",
        "message": "2 holes filled",
        "count": 2,
        "limits": {"rim_mm": 5.0},
        "places": [{"point_mm": (1.0, -2.0, 3.0), "distance_mm": 0.123456}, {"point_mm": (0, 0, 0), "note": None}],
    }
    (entry,) = change_entries([change])
    assert (entry.mesh, entry.words) == ("skin", "2 holes filled")
    assert entry.facts == (("count", "2"), ("limits, rim", "5 mm"))
    (table,) = entry.tables
    assert table.columns == ("point [mm]", "distance [mm]", "note")
    assert table.rows == (("(1.0, −2.0, 3.0)", "0.1235", "–"), ("(0.0, 0.0, 0.0)", "–", "–"))
    assert table.more == 0


def test_long_lists_are_cut_and_say_so() -> None:
    (entry,) = change_entries([{"what": "smoothed", "iterations": [{"iteration": number} for number in range(MOST_ROWS + 7)]}])
    assert entry.words == "smoothed"
    assert len(entry.tables[0].rows) == MOST_ROWS
    assert entry.tables[0].more == 7


def test_a_list_of_numbers_is_a_fact() -> None:
    (entry,) = change_entries([{"kind": "moved", "sizes": [1, 2], "none": []}])
    assert entry.words == "moved"
    assert entry.facts == (("sizes", "1, 2"), ("none", "–"))
