"""Make the pictures of docs/thesis.md from runs of the service, and print the numbers that the page states."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from scripts.handbook.thesis_decimation import (  # noqa: E402
    curvature_figure,
    decimated_bladders,
    decimation_figure,
    quarter_numbers,
)
from scripts.handbook.thesis_figures import (  # noqa: E402
    bodies_figure,
    crossing_windows,
    detached_figure,
    ears_figure,
    shells_figure,
)
from scripts.handbook.thesis_runs import thesis_runs  # noqa: E402
from scripts.handbook.thesis_shrinking import crossings, crossings_figure, shrunken  # noqa: E402

PICTURES = ROOT / "docs" / "thesis"
RUNS = ROOT / "out" / "thesis"
DPI = 110
COLOURS = 128


def main() -> int:
    """Runs that are there already are taken."""
    mpl.use("Agg")
    runs = thesis_runs(RUNS)
    PICTURES.mkdir(exist_ok=True)
    save(shells_figure(runs["shells"].surfaces), "shells")
    save(ears_figure(runs["ears"].surfaces), "ears")
    save(bodies_figure(runs["ears"].surfaces), "bodies")
    save(detached_figure(runs["detach"].before, runs["detach"].surfaces["skin"]), "detached")
    save(curvature_figure(), "curvature")
    save(decimation_figure(decimated_bladders()), "decimation")
    print("a quarter of the faces:", quarter_numbers())
    by_equation = shrunken(runs["shells"].surfaces["skin"], {"fat": 1.0, "average_body": 3.0})
    counts, taken = crossings(by_equation)
    print("by Eq. (4.1), crossing pairs:", counts)
    save(crossings_figure(by_equation["average_body"], taken["average_body"], crossing_windows()), "crossings")
    for process, run in runs.items():
        print(process, "crossing pairs:", crossings(run.surfaces)[0], run.report["summary"])
    return 0


def save(figure: Figure, name: str) -> None:
    """As a PNG of few colours, a quarter of the size."""
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", dpi=DPI)
    drawn.seek(0)
    picture = Image.open(drawn).convert("RGB").quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    path = PICTURES / f"{name}.png"
    picture.save(path, optimize=True)
    print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1000:.0f} kB, {picture.width} x {picture.height}")


if __name__ == "__main__":
    sys.exit(main())
