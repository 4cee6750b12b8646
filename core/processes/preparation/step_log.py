"""The record of a job made of steps: what each did, in how long, and whether an attempt before had done it already."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TypeVar

from core.errors import IntegumentError
from core.mesh import Mesh
from core.processes.preparation.step_record import StepRecord, StepRecords
from core.processes.processor_time import processor_s
from core.reports.figures.figure import Figure
from core.reports.steps import figures_of_step
from core.run import RunContext
from core.schema.report import StepReport

T = TypeVar("T")
Surfaces = Mapping[str, Mesh]
Draw = Callable[[Surfaces], tuple[Figure, ...]]

STEPS: Mapping[str, tuple[str, float]] = {  # name -> title, end on the progress bar
    "heal": ("Skin mended", 0.08),
    "decimate": ("Skin thinned out", 0.13),
    "detach": ("Parts that touch set apart", 0.2),
    "smooth": ("Skin smoothed", 0.22),
    "tissues": ("Inner tissues checked", 0.23),
    "ears": ("Ears found and canals cut", 0.27),
    "layers": ("Layers made", 0.5),
    "separate": ("Inner tissues set apart", 0.58),
    "validate": ("Proof on the files", 0.66),
    "tetrahedra": ("Tetrahedra filled in", 0.8),
    "package": ("Report and package", 1.0),
}
BEGIN = 0.02  # of the progress bar, when everything is loaded
UNTOLD = ("package",)  # a report cannot tell of the step that writes it


class StepLog:
    """`take` does a step or finds it done; `tell` says what it did. What is never told was not reached.

    told: called with the log after every step that is done."""

    def __init__(self, run: RunContext, told: Callable[[StepLog], object]) -> None:
        self._run = run
        self._told = told
        self._reports: dict[str, StepReport] = {}
        self._records: dict[str, StepRecord] = {}
        self._drawn: dict[str, Draw] = {}
        self._under_way = ""
        self._stage_now = run
        self.surfaces: dict[str, Mesh] = {}  # as the steps done so far leave them, outermost first

    def take(self, name: str, work: Callable[[RunContext], T], *depends: object) -> T:
        """The value of a step: kept by an attempt before, or made now; `depends` is all that decides about it."""
        made = False

        def resume(stage: RunContext) -> T:
            def make() -> T:
                nonlocal made
                made = True
                return work(stage)

            return stage.checkpoint(f"prepare: {name}", make, *depends)

        value = self.time(name, resume)
        self._records[name] = self._records[name].model_copy(update={"taken_from_attempt_before": not made})
        return value

    def time(self, name: str, work: Callable[[RunContext], T]) -> T:
        """A step that every attempt does for itself."""
        stage = self._stage(name)
        began, began_cpu, before = time.monotonic(), processor_s(), self._faces()
        value = work(stage)
        self._records[name] = StepRecord(
            name=name,
            title=STEPS[name][0],
            outcome="done",
            seconds=round(time.monotonic() - began, 3),
            processor_s=round(processor_s() - began_cpu, 3),
            faces_before=before,
        )
        return value

    def tell(self, report: StepReport, surfaces: Surfaces | None = None, draw: Draw | None = None) -> None:
        """A step is done; its record gets one line in the job's log. surfaces: those it changed, outermost first."""
        if surfaces is not None:
            self.surfaces = {**surfaces, **{name: mesh for name, mesh in self.surfaces.items() if name not in surfaces}}
        self._reports[report.name] = report
        if draw is not None:
            self._drawn[report.name] = draw
        record = self._records[report.name].done(report, self._faces())
        self._records[report.name] = record
        self._under_way = ""
        self._stage_now.log(record.line())
        self._told(self)

    def leave_out(self, name: str, why: str) -> None:
        """A step nobody asked for."""
        self._reports[name] = StepReport(name=name, title=STEPS[name][0], outcome="not_needed", summary=why)

    def fail(self, error: IntegumentError) -> None:
        """The step under way ended with an error."""
        name = self._under_way
        if name in self._records:  # its work was done; what came of it was refused
            self._records[name] = self._records[name].model_copy(update={"outcome": "failed", "summary": error.message})
        if name and name not in UNTOLD:
            self._reports[name] = StepReport(
                name=name, title=STEPS[name][0], outcome="failed", summary=error.message, findings=error.findings
            )

    def reports(self) -> tuple[StepReport, ...]:
        """One for each step, in order."""
        return tuple(
            self._reports.get(name, StepReport(name=name, title=title, outcome="not_reached", summary="a step before it failed"))
            for name, (title, _end) in STEPS.items()
            if name not in UNTOLD
        )

    def figures(self, surfaces: Surfaces) -> tuple[Figure, ...]:
        """Those of all steps that are done."""
        return tuple(figure for name, draw in self._drawn.items() for figure in figures_of_step(name, draw(surfaces)))

    def records(self) -> StepRecords:
        """With times, so it is no part of report or package: equal jobs give equal bytes there."""
        told = {step.name: StepRecord.of(step) for step in self.reports()}
        return StepRecords(steps=tuple((told | self._records)[name] for name in STEPS if name in told | self._records))

    def _stage(self, name: str) -> RunContext:
        self._under_way = name
        names = list(STEPS)
        at = names.index(name)
        self._stage_now = self._run.stage(name, STEPS[names[at - 1]][1] if at else BEGIN, STEPS[name][1])
        return self._stage_now

    def _faces(self) -> dict[str, int]:
        return {name: len(mesh.faces) for name, mesh in self.surfaces.items()}
