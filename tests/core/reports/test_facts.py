"""Facts of changes in words and units."""

from core.reports.facts import facts_of, heading


def test_units_are_said_and_digits_are_few():
    told = {"largest_shift_mm": 0.31234567, "volume_change": -0.0012, "flipped": True, "faces_kept": 26753, "at_mm": [1, 2, 3]}
    assert facts_of(told) == [
        ("largest shift", "0.3123 mm"),
        ("volume change", "−0.12 %"),
        ("flipped", "yes"),
        ("faces kept", "26\u202f753"),
        ("at", "(1.0, 2.0, 3.0) mm"),
    ]


def test_nested_facts_carry_the_words_above_them_and_nothing_is_a_dash():
    told = {"refused": {"sliver": 8}, "gap_mm": None, "names": [], "off_mm": 8e-15}
    assert facts_of(told) == [("refused, sliver", "8"), ("gap", "–"), ("names", "–"), ("off", "0 mm")]


def test_the_longest_unit_counts():
    assert [heading(key) for key in ("fat.volume_mm3", "gap_mm", "vertices")] == ["fat volume [mm³]", "gap [mm]", "vertices"]
