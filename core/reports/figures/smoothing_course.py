"""How the quality of triangles rose from iteration to iteration, and what it cost in volume."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from core.reports.figures.canvas import FAINT, sheet, to_png
from core.reports.figures.figure import Figure
from core.reports.figures.section_drawing import draw_legend, legend_height_in
from core.reports.palette import Colour, as_hex

WIDTH_IN, PLOT_IN, TICKS_IN, GUTTER = 8.4, 2.2, 0.45, 0.09
LOWEST_SHOWN = 1e-6


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
    with sheet(WIDTH_IN, total_in) as figure:
        quality = figure.add_axes((0.08, bottom, 0.48 - GUTTER / 2, height))
        volume = figure.add_axes((0.54 + GUTTER / 2, bottom, 0.44 - GUTTER / 2, height))
        for name, states in courses.items():
            colour, at = as_hex(colours[name]), delivered[name]
            lowest = [max(state.lowest_quality, LOWEST_SHOWN) for state in states]
            quality.plot(range(len(states)), lowest, color=colour, linewidth=1.4)
            quality.plot(range(len(states)), [state.mean_quality for state in states], "--", color=colour, linewidth=1.0)
            quality.plot([at], [lowest[at]], "o", color=colour, markersize=5)
            drift = _volume_drift(states)
            if drift is not None:
                volume.plot(range(len(states)), drift, color=colour, linewidth=1.4)
                volume.plot([at], [drift[at]], "o", color=colour, markersize=5)
        quality.set_yscale("log")
        quality.set_ylim(top=1.0)
        quality.minorticks_off()
        quality.yaxis.set_major_formatter(FuncFormatter(lambda value, _position: f"{value:g}"))
        _dress(quality, "quality q: lowest (solid), mean (dashed)")
        _dress(volume, "change of the volume [%]")
        draw_legend(figure, {name: colours[name] for name in courses})
        png = to_png(figure)
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


def _dress(axes: Axes, label: str) -> None:
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=8))
    axes.grid(axis="y", color=FAINT, linewidth=0.3, alpha=0.5)
    axes.set_xlabel("iteration")
    axes.set_ylabel(label)
