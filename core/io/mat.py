"""MAT: vertices `P` (V, 3) and faces `t` (F, 3) counted from 1, optional facet `normals` (F, 3); also `vertices` and `faces`.

Other vectors with one real number per vertex are kept beside the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import scipy.io
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.normals import face_normals
from core.io.indexed import assemble
from core.io.mat5 import Mat5File
from core.io.mat73 import open_mat73
from core.io.mat_arrays import load_arrays
from core.io.mat_variable import CODE_CLASSES, NUMBER_CLASSES, MatFile, MatVariable
from core.io.reading import Reading
from core.mesh import Mesh
from core.schema.finding import Finding, Severity

VERTEX_NAMES, FACE_NAMES, NORMAL_NAMES = ("P", "vertices"), ("t", "faces"), ("normals",)
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
TEXT_BYTES = 116  # free text at the begin of a version 5 header; SciPy writes the time of day there


def is_hdf5(head: bytes) -> bool:
    """True if the first 1024 bytes are those of HDF5, plain or behind MATLAB's block of 512 bytes."""
    return head.startswith((HDF5_SIGNATURE, b"MATLAB 7.3 MAT-file")) or head[512:520] == HDF5_SIGNATURE


def read(path: Path) -> Reading:
    """Read the variables above, in any case; any number class; MATLAB objects and function handles are refused.

    Raises: InputError `mat.corrupt`, `mat.variable_missing`, `mat.variable_ambiguous`, `mat.class_refused`, `mat.shape`,
    `mat.index_not_whole`, `mat.zero_based`, `hdf5.*`, `mesh.empty`, `mesh.index_out_of_range`; LimitError `mat.too_large`,
    `hdf5.too_large`.
    """
    with _open(path) as file:
        _require_no_code(file.variables)
        vertex_variable = _choose(file.variables, VERTEX_NAMES)
        face_variable = _choose(file.variables, FACE_NAMES)
        if vertex_variable is None or face_variable is None:
            raise _missing(file.variables, VERTEX_NAMES if vertex_variable is None else FACE_NAMES)
        normal_variable = _choose(file.variables, NORMAL_NAMES)
        for variable in (vertex_variable, face_variable, normal_variable):
            if variable is not None:
                _require_matrix(variable)
        vertices = file.load(vertex_variable)
        faces = _to_indices(file.load(face_variable), len(vertices), face_variable.name)
        normals = None if normal_variable is None else file.load(normal_variable)
        used = (vertex_variable, face_variable, normal_variable)
        arrays, ignored = load_arrays(file, [each for each in file.variables if each not in used], len(vertices))
    reading = assemble(vertices, faces, ignored, base=1, arrays=arrays)
    findings = () if normals is None else _check_normals(vertices, faces, normals)
    return Reading(reading.pieces, (*reading.findings, *findings))


def write(mesh: Mesh, path: Path, name: str) -> None:
    """Write version 5, uncompressed: P, t (from 1) and outward facet normals, all double. Same mesh, same bytes."""
    del name  # a MAT file has no place for it
    write_arrays(path, surface_arrays(mesh))


def surface_arrays(mesh: Mesh) -> dict[str, NDArray[np.float64]]:
    """P, t and normals as `write` has them."""
    one_based: NDArray[np.float64] = mesh.faces.astype(np.float64) + 1.0
    return {"P": mesh.vertices, "t": one_based, "normals": face_normals(mesh.vertices, mesh.faces)}


def write_arrays(path: Path, arrays: Mapping[str, NDArray[np.float64]]) -> None:
    """Write version 5, uncompressed, class double. Same arrays, same bytes."""
    scipy.io.savemat(path, dict(arrays), appendmat=False, format="5", do_compression=False)
    text = b"MATLAB 5.0 MAT-file, written by Integument, millimetres"
    with path.open("r+b") as file:
        file.write(text.ljust(TEXT_BYTES))


@contextmanager
def _open(path: Path) -> Iterator[MatFile]:
    with path.open("rb") as stream:
        head = stream.read(1024)
    if is_hdf5(head):
        with open_mat73(path) as file:
            yield file
    else:
        yield Mat5File(path.read_bytes())


def _require_no_code(variables: tuple[MatVariable, ...]) -> None:
    for variable in variables:
        if variable.matlab_class in CODE_CLASSES:
            raise InputError(
                "mat.class_refused",
                f"variable {variable.name or '(without name)'} is of class {variable.matlab_class}; objects and functions are "
                "not read: save P and t alone",
            )


def _choose(variables: tuple[MatVariable, ...], names: tuple[str, ...]) -> MatVariable | None:
    """The variable with the first of the names that occurs; its exact spelling wins over other cases."""
    for name in names:
        alike = [variable for variable in variables if variable.name.lower() == name.lower()]
        exact = [variable for variable in alike if variable.name == name]
        found = exact or alike
        if len(found) > 1:
            spellings = ", ".join(sorted(variable.name for variable in found))
            raise InputError("mat.variable_ambiguous", f"several variables may be {name}: {spellings}", count=len(found))
        if found:
            return found[0]
    return None


def _missing(variables: tuple[MatVariable, ...], names: tuple[str, ...]) -> InputError:
    held = ", ".join(f"{variable.name} {variable.shape}" for variable in variables[:10]) or "nothing"
    return InputError(
        "mat.variable_missing",
        f"no variable {' or '.join(names)} among the {len(variables)} of the file, which has {held}",
        variables=len(variables),
    )


def _require_matrix(variable: MatVariable) -> None:
    if variable.matlab_class not in NUMBER_CLASSES:
        raise InputError(
            "mat.class_refused", f"variable {variable.name} is of class {variable.matlab_class}, real numbers are needed"
        )
    if len(variable.shape) != 2 or (variable.shape[1] != 3 and 0 not in variable.shape):
        size = " x ".join(map(str, variable.shape))
        raise InputError(
            "mat.shape", f"variable {variable.name} is {size}; one row of three numbers per vertex or face is needed"
        )


def _to_indices(numbers: NDArray[np.float64], vertex_count: int, name: str) -> NDArray[np.int64]:
    """MATLAB's indices as doubles, from 1 -> int64 from 0. What is too large stays too large."""
    whole = (np.abs(numbers) < 2.0**53) & (numbers == np.floor(numbers))
    if not whole.all():
        first = float(numbers[~whole][0])
        raise InputError(
            "mat.index_not_whole", f"{int((~whole).sum())} entries of {name} are no whole numbers, the first is {first:g}"
        )
    zeros = int((numbers == 0).sum())
    if zeros:
        raise InputError(
            "mat.zero_based",
            f"{zeros} entries of {name} are 0, the largest is {numbers.max():.0f} for {vertex_count} vertices; "
            "MATLAB counts from 1: add 1 to all",
            zeros=zeros,
            largest=int(numbers.max()),
            vertices=vertex_count,
        )
    return numbers.astype(np.int64) - 1


def _check_normals(vertices: NDArray[np.float64], faces: NDArray[np.int64], normals: NDArray[np.float64]) -> tuple[Finding, ...]:
    """Compare the normals of the file with the winding of its faces, which is what counts."""
    if normals.shape != faces.shape:
        message = f"normals has {len(normals)} rows for {len(faces)} faces and was ignored"
        return (Finding(code="mat.normals_ignored", severity=Severity.WARNING, message=message, count=len(normals)),)
    with np.errstate(over="ignore", invalid="ignore"):  # coordinates are judged later
        against = int((np.einsum("ij,ij->i", face_normals(vertices, faces), normals) < 0).sum())  # type: ignore[arg-type]
    if not against:
        return ()
    message = f"{against} of {len(faces)} normals point against the winding of their faces; the winding was kept"
    return (Finding(code="mat.normals_disagree", severity=Severity.WARNING, message=message, count=against),)
