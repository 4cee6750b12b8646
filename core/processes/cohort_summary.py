"""The summary of a cohort: reads what its jobs left and compares it. The server queues it when the last has ended."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import InternalError
from core.processes.outcome import OutputFile
from core.reports.cohort.numbers import numbers_of
from core.reports.cohort.page import render_page
from core.reports.cohort.summary import sentence, summarize_cohort
from core.reports.cohort.table import render_table
from core.run import RunContext
from core.schema.cohort import CohortSummaryInputs

FILES = (
    OutputFile("table", Path("summary.csv"), "text/csv", "summary.csv"),
    OutputFile("summary", Path("summary.json"), "application/json", "summary.json"),
    OutputFile("report_html", Path("report.html"), "text/html", "report.html"),
)


def run_cohort_summary(payload: Mapping[str, Any], run: RunContext, out_dir: Path) -> dict[str, Any]:
    """As `core.processes.registry.run` returns it. Ready if every subject is.

    Raises: InternalError `cohort.report_corrupt` if a report is none."""
    inputs = CohortSummaryInputs.model_validate(payload["inputs"])
    numbers = {}
    reading = run.stage("read reports", 0.0, 0.8)
    for number, subject in enumerate(inputs.subjects, 1):
        if subject.report is not None:
            numbers[subject.subject] = numbers_of(_read(Path(payload["meshes"][subject.report]["path"]), subject.subject))
        reading.advance(number / len(inputs.subjects), f"{number} of {len(inputs.subjects)}")
    run.stage("compare", 0.8, 1.0)
    summary = summarize_cohort(inputs, numbers)
    (out_dir / "summary.csv").write_text(render_table(summary), encoding="utf-8", newline="")
    (out_dir / "summary.json").write_text(summary.model_dump_json(indent=2) + "\n", encoding="utf-8")
    (out_dir / "report.html").write_text(render_page(summary), encoding="utf-8")
    return {
        "verdict": "simulation_ready" if summary.ready == summary.subjects else "not_ready",
        "summary": sentence(summary),
        "outputs": [file.listed(out_dir) for file in FILES],
    }


def _read(path: Path, subject: str) -> dict[str, Any]:
    try:
        report = json.loads(path.read_bytes())
    except ValueError as error:
        raise InternalError("cohort.report_corrupt", f"the report of '{subject}' is no JSON: {error}", subject=subject) from error
    if not isinstance(report, dict):
        raise InternalError("cohort.report_corrupt", f"the report of '{subject}' is no JSON object", subject=subject)
    return report
