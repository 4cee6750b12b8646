"""Inputs of the process `fields`."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from core.schema.model import FrozenModel
from core.schema.reference import CoilReference, FieldReference
from core.schema.surfaces import SurfaceSubject
from core.schema.validate import MeshName

FieldUnit = Literal["V/m", "mV/mm", "V/mm", "V/cm", "mV/m"]
V_PER_M: dict[FieldUnit, float] = {"V/m": 1.0, "mV/mm": 1.0, "V/mm": 1000.0, "V/cm": 100.0, "mV/m": 0.001}
Method = Literal["auto", "nearest", "inverse_distance", "containing"]
Row = Annotated[tuple[float, float, float, float], Field(description="Four numbers of one row")]
IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
RIGID = 1e-3  # how far columns may be from unit length and right angles: files give three digits and more


class CoilPlacement(FrozenModel):
    """A coil, and where it stands."""

    file: CoilReference = Field(description="An uploaded coil (.ccd or .tcd)")
    placement: tuple[Row, Row, Row, Row] = Field(
        IDENTITY,
        description="Rows of the 4 x 4 matrix from the coil's coordinates to those of the surfaces, in mm: a turn and a shift",
    )

    @model_validator(mode="after")
    def _rigid(self) -> Self:
        turn = [row[:3] for row in self.placement[:3]]
        columns = list(zip(*turn, strict=True))
        dots = [sum(map(math.prod, zip(one, other, strict=True))) for i, one in enumerate(columns) for other in columns[i:]]
        (a, b, c), (d, e, f), (g, h, i) = turn
        turned = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
        far = max(abs(dot - wanted) for dot, wanted in zip(dots, (1, 0, 0, 1, 0, 1), strict=True))
        if self.placement[3] != IDENTITY[3] or not far <= RIGID or turned <= 0:
            raise ValueError("placement must turn and shift alone, no scale, no mirror, last row 0 0 0 1; lengths are in mm")
        return self


class FieldParameters(FrozenModel):
    """What the numbers of a field file mean, and how a triangle gets its value."""

    columns: Annotated[list[Annotated[str, Field(max_length=40)]], Field(min_length=4, max_length=1000)] | None = Field(
        None,
        description="Names of the columns of a text file from left to right: x, y, z, and Ex, Ey, Ez or magE; any other word "
        "for a column that is not used; columns beyond the last name are not used. null: as the header of the file names them",
    )
    data: str | None = Field(
        None,
        max_length=64,
        description="Name of the data of a gmsh file; null: `E`, else magnE, normE or the only one there is",
    )
    field_unit: FieldUnit = Field("V/m", description="Unit of the field in the file; results are in V/m")
    method: Method = Field(
        "auto",
        description="`nearest` point; `inverse_distance`: mean of the `neighbours` nearest points weighted by 1/d²; "
        "`containing`: in the triangle or tetrahedron of a gmsh file that holds the place, linear with values at nodes. "
        "`auto`: exact where points or triangles of the file are those of the surface, else containing for gmsh files and "
        "inverse_distance for text",
    )
    neighbours: int = Field(8, ge=2, le=64, description="Points for `inverse_distance`")
    max_distance_mm: float = Field(
        5.0, gt=0, le=100, description="A triangle farther than this from the field gets no value (NaN), and is counted and named"
    )
    inward_mm: float = Field(
        0.0, ge=0, le=20, description="How far below each triangle, against its normal, the field is taken; 0: on it"
    )
    not_finite: Literal["refuse", "leave_out"] = Field(
        "refuse",
        description="Rows of a text file with NaN or infinite numbers: refuse the file, or leave them out and count them",
    )


class FieldsInputs(FieldParameters, SurfaceSubject):
    """Surfaces, the field of a solver, and the coil it belongs to if there is one."""

    field: FieldReference = Field(description="An uploaded field: a gmsh file with data, or a matrix as text")
    only: Annotated[list[MeshName], Field(max_length=64)] = Field(
        [], description="Names of the surfaces of a package that get the field; empty: all"
    )
    coil: CoilPlacement | None = Field(None, description="A coil to be drawn beside the surfaces, its distance measured")
