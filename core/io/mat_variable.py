"""What a MAT file of any version says about one variable before its numbers are read."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

NUMBER_CLASSES = frozenset(["double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"])
CODE_CLASSES = frozenset(["object", "function_handle", "opaque"])  # what MATLAB would execute or construct
LARGEST_ARRAY_BYTES = 1 << 29  # per variable, unpacked: 22 million vertices or faces in double


@dataclass(frozen=True, slots=True)
class MatVariable:
    """Name, MATLAB class and shape as MATLAB sees them; `place` counts the variables of the file from 0."""

    name: str
    matlab_class: str
    shape: tuple[int, ...]
    place: int

    @property
    def bytes_unpacked(self) -> int:
        """What its numbers take as doubles."""
        return 8 * math.prod(self.shape)


class MatFile(Protocol):
    """An open MAT file: its variables are known, no array has been read yet."""

    @property
    def variables(self) -> tuple[MatVariable, ...]:
        """All variables at the top."""
        ...

    def load(self, variable: MatVariable) -> NDArray[np.float64]:
        """The numbers of one variable in MATLAB's shape."""
        ...
