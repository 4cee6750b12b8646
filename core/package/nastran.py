"""All surfaces as NASTRAN bulk data. Our own rows: meshio's writer ends with an error at small negative coordinates."""

from __future__ import annotations

import numpy as np

from core.package.merged_surfaces import MergedSurfaces

FILE = "nastran/surfaces.nas"


def bulk_data(surfaces: MergedSurfaces) -> str:
    """`GRID*` with 16 characters a number, nine digits of them, which bring every float32 back; `CTRIA3` whose property is the
    tissue's number. Numbers count from 1."""
    vertices, faces = surfaces.vertices, surfaces.faces
    points = np.column_stack([np.arange(1, len(vertices) + 1), vertices])
    grid = (f"GRID*   %-16.0f{'':16}%16.8E%16.8E\n*       %16.8E\n" * len(points)) % tuple(points.ravel().tolist())
    table = np.column_stack([np.arange(1, len(faces) + 1), surfaces.tags, faces + 1])
    triangles = ("CTRIA3  %-8d%-8d%-8d%-8d%-8d\n" * len(table)) % tuple(table.ravel().tolist())
    return f"$ surfaces in mm\nBEGIN BULK\n{grid}{triangles}ENDDATA\n"
