"""Shells of the full body: ours against peers, by resolution, and six layers."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from benchmarks.makers import MAKERS, VARIANTS
from benchmarks.referee import Judgement, judge
from benchmarks.table import percent, print_table, thousands
from core.io.registry import write_mesh
from subjects.body import body

OURS = "integument"
THESIS = (1.0, 3.0)
SIX = (0.3, 0.6, 1.0, 2.0, 3.0, 5.0)
LIMIT_S = 3000
HEAD = (
    "method", "exact crossing pairs", "closed", "vertices outside", "smallest gap mm", "on target", "missed with room",
    "min q", "1 % q", "min dihedral °", "TetGen pYQ", "seconds", "in E", "peak MB",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Run:
    """One maker on one body."""

    seconds: float
    peak_bytes: int
    judgement: Judgement


def run_maker(name: str, subdivisions: int, depths_mm: tuple[float, ...]) -> Run | None:
    """Make in a process of its own, judge in this one. None if the maker crashed or took too long, said on standard error."""
    with tempfile.TemporaryDirectory(prefix="bench-") as folder:
        command = [sys.executable, "-m", "benchmarks.make_shells", name, str(subdivisions), folder, *map(str, depths_mm)]
        try:
            made = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            print(f"{name}: not done after {LIMIT_S} s", file=sys.stderr)
            return None
        if made.returncode != 0:
            print(f"{name}: exit code {made.returncode}\n{made.stderr[-2000:]}", file=sys.stderr)
            return None
        skin = Path(folder) / "skin.stl"
        write_mesh(body(subdivisions), skin, "stl", "skin")
        told = json.loads(made.stdout.splitlines()[-1])
        shells = [Path(folder) / f"{row}.stl" for row in range(len(depths_mm))]
        return Run(told["seconds"], told["peak_bytes"], judge(skin, shells, depths_mm))


def compare(subdivisions: Sequence[int], *, peers_at: int | None) -> None:
    """Tables of 1 mm and 3 mm shells per resolution, with peers at one of them, and how time and memory grow."""
    ours: dict[int, Run] = {}
    for level in subdivisions:
        names = list(MAKERS) if level == peers_at else [OURS]
        runs = {name: run_maker(name, level, THESIS) for name in names}
        mine = runs[OURS]
        if mine is None:
            raise RuntimeError(f"our own engine failed on the body with {level} subdivisions; see standard error")
        ours[level] = mine
        exact = mine.judgement.exact_seconds
        faces = thousands(len(body(level).faces))
        rows = [_row(name, run, exact) for name, run in runs.items() if run is not None]
        print_table(f"{faces} faces, 1 mm and 3 mm (E = {exact:.2f} s)", HEAD, rows)
    levels = sorted(ours)
    growth = [
        (
            f"{thousands(len(body(fine).faces))} against {thousands(len(body(coarse).faces))}",
            f"{ours[fine].seconds / ours[coarse].seconds:.2f}",
            f"{ours[fine].peak_bytes / ours[coarse].peak_bytes:.2f}",
        )
        for coarse, fine in pairwise(levels)
    ]
    if growth:
        print_table("Growth of integument", ("faces", "times the seconds", "times the memory"), growth)


def six_layers(subdivisions: int) -> None:
    """Six layers at once, at the default gap and at a smaller one; E: one exact call on the seven surfaces of the row."""
    runs = {name: run_maker(name, subdivisions, SIX) for name in (OURS, *VARIANTS)}
    title = f"{thousands(len(body(subdivisions).faces))} faces, six layers {'/'.join(f'{d:g}' for d in SIX)} mm"
    rows = [
        (name, "refused, see standard error", *["-"] * (len(HEAD) - 2))
        if run is None
        else _row(name, run, run.judgement.exact_seconds)
        for name, run in runs.items()
    ]
    print_table(title, HEAD, rows)


def _row(name: str, run: Run, exact_seconds: float) -> tuple[str, ...]:
    found = run.judgement
    return (
        name,
        thousands(found.crossing_pairs),
        "yes" if found.closed else "no",
        thousands(found.vertices_outside),
        f"{found.min_gap_mm:.4f}",
        percent(found.on_target),
        percent(found.missed_with_room, 3),
        f"{found.min_quality:.2g}",
        f"{found.quality_percentile_1:.2f}",
        "-" if found.min_dihedral_deg is None else f"{found.min_dihedral_deg:.2f}",
        "no" if found.tetrahedra is None else f"{thousands(found.tetrahedra)} tetrahedra",
        f"{run.seconds:.1f}",
        f"{run.seconds / exact_seconds:.1f}",
        f"{run.peak_bytes / 1e6:.0f}",
    )
