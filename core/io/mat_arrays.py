"""Arrays of a MAT file with one number per vertex, such as depths: which variables they are, and their numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from core.errors import LimitError
from core.io.mat_variable import LARGEST_ARRAY_BYTES, NUMBER_CLASSES, MatFile, MatVariable
from core.schema.finding import Finding, Severity

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")  # MATLAB's own rule
LENGTH_SUFFIX = "_mm"  # marks what was meant as lengths on vertices, should it not fit
MOST_ARRAYS = 16


def load_arrays(
    file: MatFile, others: Iterable[MatVariable], vertex_count: int
) -> tuple[dict[str, NDArray[np.float64]], tuple[Finding, ...]]:
    """The vectors with as many real numbers as there are vertices among `others`, by name, and what was left out.

    Raises: LimitError `mat.too_large`, and what `MatFile.load` raises.
    """
    vectors = [each for each in others if each.matlab_class in NUMBER_CLASSES and _is_vector(each) and NAME.fullmatch(each.name)]
    fitting = [each for each in vectors if math.prod(each.shape) == vertex_count]
    total = sum(each.bytes_unpacked for each in fitting[:MOST_ARRAYS])
    if total > LARGEST_ARRAY_BYTES:
        raise LimitError(
            "mat.too_large",
            f"the {len(fitting[:MOST_ARRAYS])} arrays on vertices take {total} bytes, {LARGEST_ARRAY_BYTES} are allowed",
            bytes=total,
            limit=LARGEST_ARRAY_BYTES,
        )
    arrays = {each.name: file.load(each).ravel() for each in fitting[:MOST_ARRAYS]}
    ignored = [
        f"{each.name} has {math.prod(each.shape)} numbers for {vertex_count} vertices"
        for each in vectors
        if each.name.lower().endswith(LENGTH_SUFFIX) and each not in fitting
    ]
    ignored += [f"{each.name} is one of more than {MOST_ARRAYS}" for each in fitting[MOST_ARRAYS:]]
    if not ignored:
        return arrays, ()
    message = f"{len(ignored)} arrays on vertices were not kept: {'; '.join(ignored[:MOST_ARRAYS])}"
    return arrays, (Finding(code="mat.array_ignored", severity=Severity.WARNING, message=message, count=len(ignored)),)


def _is_vector(variable: MatVariable) -> bool:
    return len(variable.shape) == 2 and 1 in variable.shape and math.prod(variable.shape) > 1
