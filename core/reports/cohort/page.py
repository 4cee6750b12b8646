"""report.html of a cohort: self-contained, nothing that runs and nothing from elsewhere."""

from __future__ import annotations

from core.reports.cohort.summary import sentence, varying_columns
from core.reports.facts import heading
from core.reports.template import template
from core.reports.wording import significant
from core.schema.cohort import CohortSummary

DIGITS = 4
COLUMNS_ON_PAPER = 7  # beside subject, status and verdict on A4
SHOWN_IN = {"_mm2": ("_cm2", 1e-2), "_mm3": ("_cm3", 1e-3)}  # of a body in mm these have more digits than anybody reads


def render_page(summary: CohortSummary) -> str:
    """Names and messages are text, whatever they contain. Same summary, same bytes."""
    return template("cohort.html.j2").render(
        summary=summary,
        sentence=sentence(summary),
        columns=varying_columns(summary.rows),
        columns_on_paper=COLUMNS_ON_PAPER,
        heading=_heading,
        number=_number,
        marked={(outlier.subject, outlier.column): outlier for outlier in summary.outliers},
        troubled=[row for row in summary.rows if row.status != "successful"],
    )


def _heading(column: str) -> str:
    """`skin.area_mm2` -> `skin area [cm²]`."""
    ending = column[-4:]
    return heading(column.removesuffix(ending) + SHOWN_IN[ending][0] if ending in SHOWN_IN else column)


def _number(value: float | None, column: str) -> str:
    """In the unit of the column's heading."""
    _, scale = SHOWN_IN.get(column[-4:], ("", 1.0))
    return significant(None if value is None else value * scale, DIGITS)
