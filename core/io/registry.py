"""All formats, and the two ways in and out: an upload of any of them to meshes in mm, a mesh to any of them."""

from __future__ import annotations

from pathlib import Path, PurePath

import numpy as np

from core.errors import InputError
from core.io import glb, mat, obj, ply, stl, stl_ascii, stl_binary, vtu
from core.io.extents import check_extents
from core.io.format import Format, Writer
from core.io.naming import clean_name, make_unique
from core.io.reading import Intake, NamedMesh
from core.io.sniff import sniff
from core.io.unit import Unit, convert_to_mm
from core.mesh import Mesh

FORMATS: dict[str, Format] = {
    "stl": Format((".stl",), "model/stl", stl.read, stl_binary.write),
    "mat": Format((".mat",), "application/x-matlab-data", mat.read, mat.write),
    "ply": Format((".ply",), "application/ply", ply.read, ply.write),
    "obj": Format((".obj",), "model/obj", obj.read, obj.write),
}
WRITERS: dict[str, Writer] = {**{name: format_.write for name, format_ in FORMATS.items()}, "stl-ascii": stl_ascii.write}
WRITTEN_ONLY: dict[str, Writer] = {"glb": glb.write, "vtu": vtu.write}
FORMAT_OF_EXTENSION = {extension: name for name, format_ in FORMATS.items() for extension in format_.extensions}


def read_meshes(data_path: Path, *, file_name: str, unit: Unit) -> Intake:
    """Read an upload, whatever its format, into one mesh per solid.

    file_name is what the user called it: its extension helps to tell the format, its stem names the mesh.
    Raises: InputError `upload.empty`, `format.*`, `stl.*`, `mat.*`, `hdf5.*`, `ply.*`, `obj.*`, `mesh.*`;
    LimitError `mat.too_large`, `hdf5.too_large`; MemoryError if the process may not have what the file needs.
    """
    format_name = sniff(data_path, file_name, FORMAT_OF_EXTENSION)
    reading = FORMATS[format_name].read(data_path)
    title = clean_name(PurePath(file_name).stem, "mesh")
    # a lone solid is often called after the program that wrote it
    names = [title] if len(reading.pieces) == 1 else make_unique(piece.name or title for piece in reading.pieces)
    meshes = tuple(
        NamedMesh(name, Mesh.of(convert_to_mm(piece.vertices, piece.faces, unit), piece.faces), piece.arrays)
        for name, piece in zip(names, reading.pieces, strict=True)
    )
    corners = [corner for each in meshes for corner in (each.mesh.vertices.min(axis=0), each.mesh.vertices.max(axis=0))]
    size = check_extents(np.ptp(corners, axis=0), unit, title)
    return Intake(meshes, (*reading.findings, *size), format_name)


def write_mesh(mesh: Mesh, path: Path, format: str, name: str) -> None:  # noqa: A002 - the word of the API
    """Write `mesh` in mm. `format` is a key of WRITERS (stl is binary) or WRITTEN_ONLY; same mesh and name, same bytes.

    Raises: InputError `format.unknown`.
    """
    writers = WRITERS | WRITTEN_ONLY
    writer = writers.get(format)
    if writer is None:
        raise InputError("format.unknown", f"the format {clean_name(format)!r} is not known; use one of {', '.join(writers)}")
    writer(mesh, path, name)
