"""What comes out of a file: pieces as the format gave them, then meshes in millimetres."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.schema.finding import Finding


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """One surface in the file's own unit: vertices (V, 3) of any real type, faces (F, 3) from 0. `name` may be empty.

    arrays: name -> (V,) numbers that the file gives for each vertex, in whatever unit they have.
    """

    name: str
    vertices: NDArray[np.generic]
    faces: NDArray[np.integer]
    arrays: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Reading:
    """All that one format reader saw; at least one piece, no piece without faces."""

    pieces: tuple[Piece, ...]
    findings: tuple[Finding, ...] = ()


@dataclass(frozen=True, slots=True)
class NamedMesh:
    """A mesh in mm under the name the file (or its file name) gave; arrays: name -> (V,) as the file has them."""

    name: str
    mesh: Mesh
    arrays: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Intake:
    """A whole upload, read: `format` is a key of the registry."""

    meshes: tuple[NamedMesh, ...]
    findings: tuple[Finding, ...]
    format: str
