"""The skin a job is about: loaded, rounded to what its files will hold, and checked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.processes.named_input import load_input
from core.run import RunContext
from core.validation.requirements import require_fit_skin


@dataclass(frozen=True, eq=False, slots=True)
class LoadedSkin:
    """mesh: exact in float32; fit, if `load_skin` loaded it. changes: what rounding moved, for the report. arrays: name -> (V,)
    of the upload."""

    name: str
    mesh: Mesh
    sha256: str
    changes: tuple[dict[str, Any], ...]
    arrays: Mapping[str, NDArray[np.float64]]


def load_skin(
    href: str,
    meshes: Mapping[str, Mapping[str, Any]],
    run: RunContext,
    require: Callable[[Mesh, str], None] = require_fit_skin,
) -> LoadedSkin:
    """The first 6 % of a job. Raises: InputError `skin.*`, `reference.not_a_mesh`."""
    load = run.stage("load", 0.0, 0.02)
    source = load_rounded(href, meshes)
    load.advance(1.0, f"skin '{source.name}': {len(source.mesh.faces)} faces")
    run.stage("check the skin", 0.02, 0.06)
    require(source.mesh, "skin")
    return source


def load_rounded(href: str, meshes: Mapping[str, Mapping[str, Any]]) -> LoadedSkin:
    """The same, fit or not. Raises: InputError `reference.not_a_mesh`."""
    source = load_input(href, meshes)
    skin = source.mesh.rounded_to_float32()
    shift = float(np.abs(skin.vertices - source.mesh.vertices).max())
    changes = ({"mesh": "skin", "what": "coordinates rounded to float32", "largest_shift_mm": shift},) if shift else ()
    return LoadedSkin(source.name, skin, source.sha256, changes, source.arrays)
