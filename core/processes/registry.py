"""From a job to its files: the one entry of the job child, and the warm-up of its parent."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from core.errors import IntegumentError, StateError
from core.processes.checkpoints.kept_steps import KeptSteps
from core.processes.cohort_summary import run_cohort_summary
from core.processes.decimate import run_decimate
from core.processes.delivered_checksums import with_checksums
from core.processes.detach import run_detach
from core.processes.ears import run_ears
from core.processes.failure import failure_outcome
from core.processes.fields import run_fields
from core.processes.graft import run_graft
from core.processes.heal import run_heal
from core.processes.outcome import Outcome, OutputFile
from core.processes.prepare import run_prepare
from core.processes.rehearsal import rehearse
from core.processes.segment import run_segment
from core.processes.separate import run_separate
from core.processes.shells import run_shells
from core.processes.smooth import run_smooth
from core.processes.software import software_digest
from core.processes.tetrahedralize import run_tetrahedralize
from core.processes.validate import run_validate
from core.processes.warm_up import warm_up_steps
from core.reports.html import render_html
from core.reports.scene.mailable import mailable_faces
from core.reports.scene.scene import make_scene
from core.run import RunContext, RunEvent
from core.schema.cohort import COHORT_SUMMARY
from core.schema.processes import PROCESSES

__all__ = ["HANDLERS", "leisure_steps", "run", "warm_up"]

Handler = Callable[[Any, Mapping[str, Mapping[str, Any]], RunContext, Path], Outcome]
HANDLERS: dict[str, Handler] = {
    "validate": run_validate,
    "shells": run_shells,
    "ears": run_ears,
    "graft": run_graft,
    "heal": run_heal,
    "decimate": run_decimate,
    "smooth": run_smooth,
    "detach": run_detach,
    "segment": run_segment,
    "separate": run_separate,
    "tetrahedralize": run_tetrahedralize,
    "fields": run_fields,
    "prepare": run_prepare,
}


class EventSink(Protocol):
    """Where progress goes; the sandbox's channel fits."""

    def send(self, message: dict[str, Any]) -> None:
        """Send one event as JSON."""
        ...


def warm_up() -> None:
    """For the process whose forks run jobs, before the first of them: what each needs whatever it does."""
    rehearse(run)


def leisure_steps() -> Sequence[Callable[[], object]]:
    """For the same process, while nobody waits for it: what only some jobs need."""
    return warm_up_steps()


def run(payload: dict[str, Any], channel: EventSink) -> dict[str, Any]:
    """Execute one job.

    payload: {"process", "inputs", "meshes": {href: {"path", "name", "sha256", "media_type", "file_name"}}, "out_dir"}, and
    if steps are kept "checkpoints": {"folder", "kept": {key: path}, "worth_s", "room_bytes"}; a step kept is announced by a
    message {"kind": "checkpoint", "key", "stage"}. Files that stay if the work is ended from outside are announced by
    {"kind": "left", "outputs"}, listed as below.
    Returns {"verdict", "summary", "outputs": [{"name", "path", "media_type", "file_name"}]} with paths below `out_dir`'s
    parent as given. Raises: IntegumentError, whose `outputs` name the report, and what else was left nevertheless.
    """
    out_dir = Path(payload["out_dir"])
    process: str = payload["process"]
    context = RunContext(
        sink=lambda event: channel.send(_message(event)),
        checkpoints=_kept_steps(payload, channel),
        on_left=lambda files: channel.send({"kind": "left", "outputs": list(files)}),
    )
    if process == COHORT_SUMMARY:
        return run_cohort_summary(payload, context, out_dir)
    if process not in HANDLERS:
        raise StateError("process.not_found", f"there is no process '{process}'", process=process)
    try:
        inputs = PROCESSES[process].inputs.model_validate(payload["inputs"])
        outcome = HANDLERS[process](inputs, payload["meshes"], context, out_dir)
    except IntegumentError as error:
        failed = failure_outcome(process, payload, error)
        error.outputs = (*error.outputs, *(file.listed(out_dir) for file in _write_report(failed, out_dir)))
        raise
    files = (*outcome.files, *_write_report(outcome, out_dir))
    return {
        "verdict": outcome.report.verdict,
        "summary": outcome.report.summary,
        "outputs": [file.listed(out_dir) for file in files],
    }


def _write_report(outcome: Outcome, out_dir: Path) -> tuple[OutputFile, ...]:
    report = with_checksums(outcome.report, outcome.files, out_dir)
    (out_dir / "report.json").write_text(report.model_dump_json(indent=2) + "\n", encoding="utf-8")
    scene = make_scene(outcome.surfaces, outcome.depths_mm, mailable_faces(outcome.figures), outcome.painted)
    page = render_html(report, outcome.figures, scene)
    (out_dir / "report.html").write_text(page, encoding="utf-8")
    return (
        OutputFile("report", Path("report.json"), "application/json", "report.json"),
        OutputFile("report_html", Path("report.html"), "text/html", "report.html"),
    )


def _kept_steps(payload: Mapping[str, Any], channel: EventSink) -> KeptSteps | None:
    asked = payload.get("checkpoints")
    if asked is None:
        return None
    return KeptSteps(
        software_digest(),
        {key: Path(path) for key, path in asked["kept"].items()},
        Path(asked["folder"]),
        lambda key, stage: channel.send({"kind": "checkpoint", "key": key, "stage": stage}),
        worth_s=asked["worth_s"],
        room_bytes=asked["room_bytes"],
    )


def _message(event: RunEvent) -> dict[str, Any]:
    return {"kind": event.kind, "progress": event.progress, "phase": event.phase, "message": event.message}
