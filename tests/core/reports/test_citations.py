"""References as a paper numbers them."""

from core.reports.citations import in_order_of_citation
from core.schema.report import Report


def cited(methods: str, *references: str) -> tuple[str, tuple[str, ...]]:
    report = Report(process="shells", verdict="not_ready", summary="", methods=methods, references=references)
    return in_order_of_citation(report)


def test_the_first_work_cited_is_the_first_and_others_are_left_out() -> None:
    text, works = cited("Moved as in [3], proven [1], as [3] says.", "[1] libigl", "[2] nobody", "[3] Htet", "no number")
    assert text == "Moved as in [1], proven [2], as [1] says."
    assert works == ("[1] Htet", "[2] libigl", "no number")


def test_several_works_in_one_bracket_are_each_renumbered() -> None:
    text, works = cited("Marched [4, 2], proven [1, 2].", "[1] libigl", "[2] Taubin", "[3] nobody", "[4] Bloomenthal")
    assert text == "Marched [1, 2], proven [2, 3]."
    assert works == ("[1] Bloomenthal", "[2] Taubin", "[3] libigl")


def test_brackets_that_are_no_citation_stay() -> None:
    assert cited("Boxes [7] of [1].", "[1] libigl") == ("Boxes [7] of [1].", ("[1] libigl",))
