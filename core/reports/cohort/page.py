"""report.html of a cohort: self-contained, nothing that runs and nothing from elsewhere."""

from __future__ import annotations

from core.reports.cohort.summary import sentence, varying_columns
from core.reports.template import template
from core.schema.cohort import CohortSummary


def render_page(summary: CohortSummary) -> str:
    """Names and messages are text, whatever they contain. Same summary, same bytes."""
    return template("cohort.html.j2").render(
        summary=summary,
        sentence=sentence(summary),
        columns=varying_columns(summary.rows),
        marked={(outlier.subject, outlier.column): outlier for outlier in summary.outliers},
        troubled=[row for row in summary.rows if row.status != "successful"],
    )
