"""Inputs of `heal` without a server, and what must be true of every result."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.healing.heal import Healed, heal
from core.mesh import Mesh
from core.schema.heal import HealInputs
from core.validation.validate import validate

SOME_MESH = {"href": "/v1/meshes/00000000-0000-0000-0000-000000000000"}


def inputs(**options: Any) -> HealInputs:
    """The inputs with a reference that nobody follows."""
    return HealInputs(mesh=SOME_MESH, **options)


def healed(mesh: Mesh, **options: Any) -> Healed:
    """Heal, and hold every promise that does not depend on the fault."""
    made = heal(mesh, inputs(**options))
    validation = validate({"healed": made.mesh})
    assert validation.verdict == "simulation_ready", validation.findings
    require_same(heal(made.mesh, inputs(**{**options, "staircase": False})).mesh, made.mesh)
    assert np.array_equal(made.mesh.vertices, made.mesh.rounded_to_float32().vertices)
    rounded = mesh.rounded_to_float32().triangles()
    kept = made.former >= 0
    # bit for bit, whichever way round
    assert np.array_equal(ordered(made.mesh.triangles()[kept]), ordered(rounded[made.former[kept]]))
    return made


def require_same(a: Mesh, b: Mesh) -> None:
    """Equal bytes."""
    assert a.vertices.tobytes() == b.vertices.tobytes()
    assert a.faces.tobytes() == b.faces.tobytes()


def ordered(triangles: np.ndarray) -> np.ndarray:
    """Corners of each triangle in an order that does not depend on where it begins, or on its direction."""
    return np.array([sorted(map(tuple, triangle)) for triangle in triangles.tolist()])


def kinds(made: Healed) -> list[str]:
    """Kinds of the changes, without the summary."""
    assert all(change["kind"] != "extent" for change in made.changes[:-1])
    return [change["kind"] for change in made.changes[:-1]]
