"""Headlines say what was refused in a few words; large numbers are grouped, names and codes are left alone."""

import pytest

from core.reports.prose import LONGEST_CLAUSE, grouped, headline, sentence, verdict_words
from core.schema.report import FailureReport


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("at 514 of 26756 faces", "at 514 of 26\u202f756 faces"),
        ("26,756 faces, 1,234,567 edges", "26\u202f756 faces, 1\u202f234\u202f567 edges"),
        ("from 2015, 8460 faces", "from 2015, 8460 faces"),
        ("12345.5 mm, 0.000125 mm, 3.72e+05 mm²", "12345.5 mm, 0.000125 mm, 3.72e+05 mm²"),
        (
            "'case 123456' and \"98765\" of body_12345.stl, doi:10.1000/123456",
            "'case 123456' and \"98765\" of body_12345.stl, doi:10.1000/123456",
        ),
        ("at (100, 200, 300) mm", "at (100, 200, 300) mm"),
        ("12345. Then 67890; done", "12\u202f345. Then 67\u202f890; done"),
    ],
)
def test_large_numbers_are_grouped_and_nothing_else(text: str, shown: str) -> None:
    assert grouped(text) == shown


@pytest.mark.parametrize(
    ("message", "said"),
    [
        ("no contact in the region 'arm': the body there has one part only", "no contact in the region 'arm'"),
        (
            "at 514 of 26756 faces the skin is too thin for layer 'fat' at 1 mm (least room 0.177 mm) and",
            "at 514 of 26\u202f756 faces the skin is too thin for layer 'fat' at 1 mm",
        ),
        ("no two ears were found: the surface does not stand", "no two ears were found"),
        ("no voxel has the label 7; the volume has 1, 2", "no voxel has the label 7"),
        (
            "the surface is an open sheet of 3.72e+05 mm² that encloses nothing, so it cannot be closed to a body",
            "the surface is an open sheet of 3.72e+05 mm² that encloses nothing",
        ),
        ("skin: 3 holes are left, the longest rim is 12 mm", "skin: 3 holes are left, the longest rim is 12 mm"),
        ("`max_hole_mm` is too small.", "max_hole_mm is too small"),
    ],
)
def test_a_headline_is_the_first_clause(message: str, said: str) -> None:
    assert headline(message)[0] == said


def test_what_the_headline_leaves_is_said_below_it() -> None:
    assert headline("no voxel has the label 7; the volume has 1, 2") == ("no voxel has the label 7", "the volume has 1, 2")
    too_thin = "the skin is too thin for layer 'fat' (least room 0.2 mm) and thin_policy is 'fail'"
    assert headline(too_thin) == ("the skin is too thin for layer 'fat'", too_thin)
    assert headline("no two ears were found.") == ("no two ears were found", "")


def test_a_headline_never_runs_on() -> None:
    said, rest = headline("word " * 100)
    assert rest == "word " * 100
    assert len(said) <= LONGEST_CLAUSE + 2
    assert said.endswith(" …")


def test_sentences_begin_with_a_capital_unless_a_name_does() -> None:
    assert sentence("at 5 faces `min_gap_mm` is not kept") == "At 5 faces min_gap_mm is not kept"
    assert sentence("left_ear: 3 faces") == "left_ear: 3 faces"
    assert sentence("skin is open", ["skin"]) == "skin is open"


@pytest.mark.parametrize(
    ("fault", "words"),
    [("input", "Refused"), ("limit", "Stopped at a limit of this server"), ("internal", "Failed by a fault of the server")],
)
def test_what_failed_is_not_called_not_ready(fault: str, words: str) -> None:
    assert verdict_words("shells", False, FailureReport(code="a.b", fault=fault)) == words  # type: ignore[arg-type]
    assert verdict_words("shells", False) == "Not ready"
