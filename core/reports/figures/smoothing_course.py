"""How the quality of triangles rose from iteration to iteration, and what it cost in volume."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np

from core.reports.figures.canvas import Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.plot import Plot, round_values
from core.reports.figures.section_drawing import draw_legend, legend_height_in
from core.reports.palette import Colour, as_hex

WIDTH_IN, PLOT_IN, TICKS_IN, GUTTER = 8.4, 2.2, 0.45, 0.09
LOWEST_SHOWN = 1e-6
EDGE = 0.05  # of the range stays free at both ends
SMALLEST_DRIFT = 1e-4  # percent
LABEL_PT = 36.0


class State(Protocol):
    """A surface after one iteration; `core.smoothing.progress.Progress` fits."""

    @property
    def lowest_quality(self) -> float:
        """Of the faces that may change."""
        ...

    @property
    def mean_quality(self) -> float:
        """Of the same faces."""
        ...

    @property
    def volume_mm3(self) -> float | None:
        """None for an open surface."""
        ...


def draw_smoothing_course(
    courses: Mapping[str, Sequence[State]], delivered: Mapping[str, int], colours: Mapping[str, Colour]
) -> Figure:
    """Left the lowest (solid) and mean (dashed) quality, logarithmic, right the volume; a dot marks the state delivered.

    courses: name -> states, before the first iteration and after each.
    """
    total_in = legend_height_in(len(courses)) + PLOT_IN + TICKS_IN
    bottom, height = TICKS_IN / total_in, PLOT_IN / total_in
    sheet = Sheet(WIDTH_IN, total_in)
    last = max(1, *(len(states) - 1 for states in courses.values()))
    lowest_of_all = min(max(state.lowest_quality, LOWEST_SHOWN) for states in courses.values() for state in states)
    drifts = {name: drift for name, states in courses.items() if (drift := _volume_drift(states)) is not None}
    floor, ceiling = _drift_window(drifts)
    decade = float(10.0 ** np.floor(np.log10(lowest_of_all) - 1e-9))
    box = (0.08, bottom, 0.48 - GUTTER / 2, height)
    quality = Plot(sheet, box, (-EDGE * last, decade), ((1 + EDGE) * last, 1.0), log_y=True)
    box = (0.54 + GUTTER / 2, bottom, 0.44 - GUTTER / 2, height)
    volume = Plot(sheet, box, (-EDGE * last, floor), ((1 + EDGE) * last, ceiling))
    quality.ticks_y([10.0**power for power in range(-6, 1)], lambda value: f"{value:g}", grid=True)
    volume.ticks_y(round_values(floor, ceiling, 8), lambda value: f"{value:g}".replace("-", "−"), grid=True)
    _dress(quality, last, "quality q: lowest (solid), mean (dashed)")
    _dress(volume, last, "change of the volume [%]")
    for name, states in courses.items():
        colour, at, count = as_hex(colours[name]), delivered[name], np.arange(len(states))
        lowest = [max(state.lowest_quality, LOWEST_SHOWN) for state in states]
        quality.line(count, lowest, colour, 1.4)
        quality.line(count, [max(state.mean_quality, LOWEST_SHOWN) for state in states], colour, 1.0, dashed=True)
        quality.dot(at, lowest[at], colour, 5)
        if name in drifts:
            volume.line(count, drifts[name], colour, 1.4)
            volume.dot(at, drifts[name][at], colour, 5)
    draw_legend(sheet, {name: colours[name] for name in courses})
    png = sheet.png()
    words = [
        f"{name} {states[0].lowest_quality:.2g} to {states[delivered[name]].lowest_quality:.2g} after {delivered[name]} of "
        f"{len(states) - 1} iterations made"
        for name, states in courses.items()
    ]
    caption = f"Lowest and mean triangle quality around the vertices that may move, and volume, by iteration. {'; '.join(words)}."
    return Figure("smoothing_course", "Quality by iteration", caption, png)


def _volume_drift(states: Sequence[State]) -> list[float] | None:
    """Percent of the first; None for an open surface."""
    volumes = [state.volume_mm3 for state in states]
    first = volumes[0]
    if not first:
        return None
    return [100.0 * ((volume or 0.0) / first - 1.0) for volume in volumes]


def _drift_window(drifts: Mapping[str, Sequence[float]]) -> tuple[float, float]:
    """Lower and upper end of the axis: all values, with a little room, and never without any height."""
    values = [value for drift in drifts.values() for value in drift]
    low, high = min(values, default=0.0), max(values, default=0.0)
    room = max(EDGE * (high - low), SMALLEST_DRIFT)
    return low - room, high + room


def _dress(plot: Plot, last: int, label: str) -> None:
    plot.rim()
    plot.ticks_x(round_values(0.0, float(last), 8, whole=True), lambda value: f"{value:g}")
    plot.label_x("iteration")
    plot.label_y(label, LABEL_PT)
