"""One subject through the engine, and everything the engine promises about the result, judged by the exact referee."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from core.errors import InputError
from core.mesh import Mesh
from core.schema.finding import Severity
from core.schema.shells import Layer, ShellsInputs
from core.shells.nested_shells import Shell, create_shells
from core.shells.thickness import measure_thickness
from core.validation.requirements import require_fit_skin
from core.validation.validate import Validation, validate

READY = "ready"
ANY_MESH = {"href": "/v1/meshes/00000000-0000-0000-0000-000000000000"}  # the engine gets the mesh itself


@dataclass(frozen=True, slots=True)
class Trial:
    """How a subject ended. outcome: `ready`, or the code of the refusal. The rest is None where there are no shells.

    on_target: share of each layer's area. broken: what the referee holds against shells that were handed out, or against a
    refusal that names no place; empty is right.
    """

    faces: int
    outcome: str
    seconds: float
    broken: tuple[str, ...]
    places: int = 0
    on_target: tuple[float, ...] = ()
    min_gap_mm: float | None = None
    min_quality: float | None = None


def shells_inputs(depths_mm: tuple[float, ...], min_gap_mm: float = 0.05) -> ShellsInputs:
    """A request for layers at these depths."""
    layers = tuple(Layer(name=f"layer_{row + 1}", depth_mm=depth) for row, depth in enumerate(depths_mm))
    return ShellsInputs.model_validate({"skin": ANY_MESH, "layers": layers, "min_gap_mm": min_gap_mm})


def attempt(skin: Mesh, depths_mm: tuple[float, ...], min_gap_mm: float = 0.05) -> Trial:
    """Ask for fit skin, make shells, prove them. Anything raised but a refusal of the input is a defect and gets out."""
    inputs = shells_inputs(depths_mm, min_gap_mm)
    start = time.perf_counter()
    try:
        require_fit_skin(skin, "skin")
        shells = create_shells(skin, inputs)
    except InputError as refusal:
        places = sum(len(finding.places) for finding in refusal.findings)
        broken = () if places and refusal.facts else (f"{refusal.code} names {places} places and {len(refusal.facts)} facts",)
        return Trial(len(skin.faces), refusal.code, time.perf_counter() - start, broken, places)
    seconds = time.perf_counter() - start
    surfaces = {"skin": skin, **{shell.name: shell.mesh for shell in shells}}
    proof = validate(surfaces, min_gap_mm=min_gap_mm)
    return Trial(
        len(skin.faces),
        READY,
        seconds,
        find_broken_promises(surfaces, shells, proof, min_gap_mm),
        on_target=tuple(measure_thickness(shell, depth).on_target_area for shell, depth in zip(shells, depths_mm, strict=True)),
        min_gap_mm=min(pair.min_gap_mm for pair in proof.pairs if pair.min_gap_mm is not None),
        min_quality=min(proof.meshes[shell.name].quality.minimum for shell in shells),
    )


def find_broken_promises(
    surfaces: Mapping[str, Mesh], shells: tuple[Shell, ...], proof: Validation, min_gap_mm: float
) -> tuple[str, ...]:
    """What is wrong with a set of shells, in words; surfaces: skin first, then the shells inwards."""
    names = list(surfaces)
    broken = [finding.message for finding in proof.findings if finding.severity is Severity.ERROR]
    if list(proof.nesting.items()) != list(zip(names, (None, *names), strict=False)):
        broken.append(f"nesting is {proof.nesting}")
    genera = {name: report.genus for name, report in proof.meshes.items()}
    if len(set(genera.values())) != 1:
        broken.append(f"the genus changes: {genera}")
    gaps = {(pair.a, pair.b): pair.min_gap_mm for pair in proof.pairs}
    for pair in pairwise(names):
        gap = gaps.get(pair)
        if gap is None or gap < min_gap_mm:
            broken.append(f"the gap between {pair[0]} and {pair[1]} is {gap} mm")
    broken += [
        f"{shell.name} does not survive single precision"
        for shell in shells
        if not np.array_equal(shell.mesh.vertices, shell.mesh.vertices.astype(np.float32))
    ]
    return tuple(broken)
