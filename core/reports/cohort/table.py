"""summary.csv: a line per subject, for spreadsheets and scripts."""

from __future__ import annotations

import csv
import io

from core.reports.cohort.summary import columns_of
from core.schema.cohort import CohortSummary

HEAD = ("subject", "job", "status", "verdict", "code", "message", "outliers")
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # OWASP, CSV injection: a spreadsheet would work out what begins so


def render_table(summary: CohortSummary) -> str:
    """RFC 4180, UTF-8, decimal points; empty where there is no number."""
    marked: dict[str, list[str]] = {}
    for outlier in summary.outliers:
        marked.setdefault(outlier.subject, []).append(outlier.column)
    columns = columns_of(summary.rows)
    written = io.StringIO()
    table = csv.writer(written)
    table.writerow([*HEAD, *map(_text, columns)])
    for row in summary.rows:
        told = (row.subject, row.job, row.status, row.verdict, row.code, row.message, "; ".join(marked.get(row.subject, ())))
        table.writerow([*map(_text, told), *(row.numbers.get(column, "") for column in columns)])
    return written.getvalue()


def _text(value: str | None) -> str:
    """Never a formula: names come from whoever sent them."""
    told = value or ""
    return f"'{told}" if told.startswith(FORMULA) else told
