"""A field as a file gives it: numbers in a table, or values at the nodes and in the elements of a mesh. Frozen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Where: TypeAlias = Literal["nodes", "elements"]


@dataclass(frozen=True, eq=False, slots=True)
class FieldTable:
    """Columns of numbers; which of them are places and which the field is said when it is used.

    names: one per column, empty where the file names none. columns: (K, N) float64 as in the file, NaN included.
    mm_per_unit: of the columns that are places.
    """

    names: tuple[str, ...]
    columns: Floats
    mm_per_unit: float


@dataclass(frozen=True, eq=False, slots=True)
class FieldData:
    """One quantity under its name: values (N, 1) or (N, 3), a row per node, or per element with triangles first; NaN: none."""

    name: str
    where: Where
    values: Floats


@dataclass(frozen=True, eq=False, slots=True)
class FieldMesh:
    """Nodes (V, 3) mm, triangles (T, 3) and tetrahedra (K, 4) of them, int32 from 0, and what is known on them."""

    nodes: Floats
    triangles: NDArray[np.int32]
    tetrahedra: NDArray[np.int32]
    data: tuple[FieldData, ...]


FieldSource: TypeAlias = FieldTable | FieldMesh
