"""README of the files of a field: how each program loads them."""

from __future__ import annotations

from core.schema.report import Report

TEXT = """Field on surfaces, made by Integument
=====================================

{summary}

Lengths in mm, the field in V/m. A triangle farther than the limit from the field has NaN.

mat/<surface>.mat   MATLAB: P (V,3), t (F,3) from 1, normals (F,3){vector}, magE (F,1), distance_mm (F,1), all double{coil}
                    S = load('mat/{first}.mat'); patch('Faces', S.t, 'Vertices', S.P, 'FaceVertexCData', S.magE, ...
                        'FaceColor', 'flat', 'EdgeColor', 'none'); axis equal; colorbar
vtu/<surface>.vtu   ParaView: cell data{vtu_vector} magE, distance_mm
gmsh/fields.msh     gmsh, SimNIBS: all surfaces, ElementData{vtu_vector} magnE, distance_mm; tags 1000 + number of the tissue
statistics.csv      one row per surface: mean, 99th percentile and maximum by area, normal and tangential parts
figures/            the field from five sides
report.json         all numbers, parameters and checksums of what went in
"""


def field_readme(report: Report) -> str:
    """The text; the same report gives the same."""
    is_vector = any(each.normal is not None for each in report.fields.values())
    return TEXT.format(
        summary=report.summary,
        first=next(iter(report.fields)),
        vector=", E (F,3)" if is_vector else "",
        vtu_vector=" E," if is_vector else "",
        coil="; coil_positions in mm, coil_moments in A m^2" if report.coil is not None else "",
    )
