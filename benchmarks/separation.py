"""`python -m benchmarks.separation [--picture FILE.png]`: tissues of a real head moved apart; the table of its algorithm page."""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.mesh import Mesh
from core.reports.figures.opened_gaps import draw_opened_gaps
from core.reports.palette import tissue_colours
from core.schema.separate import SeparateInputs
from core.separation.separate import Separation, separate
from core.tetrahedra.fill import fill
from core.validation.validate import Validation, validate
from subjects.head_tissues import NOWHERE, head_tissues, layered_head_tissues

CASES: tuple[tuple[str, bool, Mapping[str, Any]], ...] = (
    ("head, inner skull, grey and white", False, {"fixed": ["skin"]}),
    ("the same and three layers", True, {"fixed": ["skin"]}),
    ("the same, white matter first", True, {"fixed": ["skin"], "priority": {"white_left": 1, "white_right": 1}}),
    ("the same, 0.5 mm", True, {"fixed": ["skin"], "min_gap_mm": 0.5}),
)


def main() -> None:
    """A row for every case; the picture is of the last but two."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--picture", type=Path)
    picture = parser.parse_args().picture
    _separated(head_tissues(), {})  # kernels compiled before
    for title, layered, asked in CASES:
        tissues = layered_head_tissues() if layered else head_tissues()
        before = validate(tissues)
        start = time.process_time()
        made = _separated(tissues, asked)
        cpu_s = time.process_time() - start
        after = {name: tissue.mesh for name, tissue in made.tissues.items()}
        print(_row(title, before, made, validate(after, min_gap_mm=asked.get("min_gap_mm", 0.1)), after, cpu_s))
        if picture and layered and len(asked) == 1:
            figure = draw_opened_gaps(tissues, after, tissue_colours(list(after)))
            if figure:
                picture.write_bytes(figure.png)


def _separated(tissues: Mapping[str, Mesh], asked: Mapping[str, Any]) -> Separation:
    return separate(tissues, SeparateInputs(meshes=dict.fromkeys(tissues, NOWHERE), **asked))


def _row(title: str, before: Validation, made: Separation, proof: Validation, after: Mapping[str, Mesh], cpu_s: float) -> str:
    """Names, faces, intersecting pairs before and after, gap, moves, CPU seconds, and regions that TetGen finds."""
    shifts = np.concatenate([tissue.shift_mm for tissue in made.tissues.values()])
    moved = shifts[shifts > 0.0]
    filled = fill(after, proof.nesting, gap_mm=min(made.gaps_mm.values()))
    cells = (
        title,
        f"{len(after)}",
        f"{sum(len(mesh.faces) for mesh in after.values()):,}",
        f"{sum(pair.intersecting_pairs for pair in before.pairs):,}",
        f"{sum(pair.intersecting_pairs for pair in proof.pairs)}",
        f"{min(made.gaps_mm.values()):.4f}",
        f"{len(moved):,}",
        f"{moved.mean():.3f}",
        f"{moved.max():.3f}",
        f"{cpu_s:.1f}",
        f"{len(np.unique(filled.region))} in {len(filled.tetrahedra):,}",
    )
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
