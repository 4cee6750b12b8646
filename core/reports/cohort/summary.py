"""From how every subject ended, and the numbers of those that left a report, to the summary of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from core.reports.cohort.outliers import METHODS, find_outliers, summarize_column
from core.schema.cohort import CohortSummary, CohortSummaryInputs, EndedSubject, SubjectRow

READY = "simulation_ready"


def summarize_cohort(inputs: CohortSummaryInputs, numbers: Mapping[str, Mapping[str, float]]) -> CohortSummary:
    """numbers: subject -> column -> value. Of a job that did not succeed they are shown, and compared with nobody's."""
    columns: dict[str, dict[str, float]] = {}
    for subject in inputs.subjects:
        if subject.status == "successful":
            for column, value in numbers.get(subject.subject, {}).items():
                columns.setdefault(column, {})[subject.subject] = value
    rows = tuple(_row(subject, numbers.get(subject.subject, {})) for subject in inputs.subjects)
    return CohortSummary(
        process=inputs.process,
        name=inputs.name,
        subjects=len(rows),
        ready=sum(row.verdict == READY for row in rows),
        not_ready=sum(row.status == "successful" and row.verdict != READY for row in rows),
        failed=sum(row.status == "failed" for row in rows),
        dismissed=sum(row.status == "dismissed" for row in rows),
        refused=sum(row.status == "refused" for row in rows),
        columns={name: summarize_column(values) for name, values in columns.items()},
        outliers=tuple(outlier for name, values in columns.items() for outlier in find_outliers(name, values)),
        rows=rows,
        methods=METHODS,
    )


def sentence(summary: CohortSummary) -> str:
    """For people: how it went in one sentence."""
    parts = [f"{summary.ready} of {summary.subjects} subjects are simulation ready"]
    others = {
        "not ready": summary.not_ready,
        "failed": summary.failed,
        "dismissed": summary.dismissed,
        "refused": summary.refused,
    }
    parts += [f"{count} {word}" for word, count in others.items() if count]
    marked = len({outlier.subject for outlier in summary.outliers})
    if marked:
        parts.append(f"{marked} with numbers far from the others'")
    return ", ".join(parts) + "."


def columns_of(rows: Sequence[SubjectRow]) -> list[str]:
    """All columns, in the order they first come up."""
    return list(dict.fromkeys(column for row in rows for column in row.numbers))


def varying_columns(rows: Sequence[SubjectRow]) -> list[str]:
    """Those whose number is not the same for all that have numbers."""
    numbers = [row.numbers for row in rows if row.numbers]
    return [column for column in columns_of(rows) if len({own.get(column) for own in numbers}) > 1]


def _row(subject: EndedSubject, numbers: Mapping[str, float]) -> SubjectRow:
    return SubjectRow(
        subject=subject.subject,
        job=subject.job,
        status=subject.status,
        verdict=subject.verdict,
        code=subject.code,
        message=subject.message,
        numbers=dict(numbers),
    )
