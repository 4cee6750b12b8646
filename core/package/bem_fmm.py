"""Index files of BEM-FMM: which surface bounds which tissue, how well it conducts, what is around it."""

from __future__ import annotations

from collections.abc import Sequence

from core.package.tissue import Tissue

FOLDER = "bem-fmm"


def matlab_index(tissues: Sequence[Tissue]) -> str:
    """`tissue_index.txt`: the reader takes lines that begin with `>` and have exactly three colons, all others are notes.

    It loads the MAT files by name from the current folder or the MATLAB path, so they must lie beside it.
    """
    rows = [f">{each.name} : {each.name}.mat : {_number(each.conductivity_s_per_m)} : {each.enclosing}" for each in tissues]
    return "\n".join(["# name, file, conductivity inside in S/m, enclosing tissue", *rows]) + "\n"


def python_index(tissues: Sequence[Tissue]) -> str:
    """`tissue_index.yaml`: name, then S/m inside, enclosing tissue and mesh file, relative to the index."""
    rows = [
        # quoted: YAML takes a bare `no` or `1e3` for something else
        f'  "{each.name}": [{_number(each.conductivity_s_per_m)}, "{each.enclosing}", "../stl/{each.name}.stl"]'
        for each in tissues
    ]
    return "\n".join(["shells:", *rows]) + "\n"


def _number(conductivity: float) -> str:
    """Four decimals where they hold the value, else as many digits as it takes; never an exponent YAML would not know."""
    short = f"{conductivity:.4f}"
    return short if float(short) == conductivity else f"{conductivity:.17f}".rstrip("0")
