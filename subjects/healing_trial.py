"""What healing made of a defective surface, judged by the exact referee and the healthy surface; the same for everybody."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.deviation import measure_deviation
from core.healing.heal import heal
from core.mesh import Mesh
from core.schema.finding import Severity
from core.schema.heal import HealInputs
from core.validation.validate import Validation, validate
from subjects.defects import Defective

ANY_MESH = {"href": "/v1/meshes/00000000-0000-0000-0000-000000000000"}  # the engine gets the mesh itself


@dataclass(frozen=True, slots=True)
class HealingJudgement:
    """broken: what is wrong with the result, in words; empty is right. kept: share of the sound triangles, those that the
    damaged surface has in common with the healthy one, that the result still has at the same places, bit for bit."""

    broken: tuple[str, ...]
    deviation_mm: float
    kept: float


@dataclass(frozen=True, slots=True)
class HealingTrial:
    """outcome: `ready`, `wrong`, or the code of the refusal, for which there is no judgement."""

    outcome: str
    seconds: float
    judgement: HealingJudgement | None


def attempt_healing(entry: Defective) -> HealingTrial:
    """Heal with the entry's options. Anything raised but a refusal of the input is a defect and gets out."""
    damaged = entry.make()
    start = time.process_time()
    try:
        healed = heal(damaged, heal_inputs(entry))
    except InputError as refusal:
        return HealingTrial(refusal.code, time.process_time() - start, None)
    seconds = time.process_time() - start
    judgement = judge_healing(entry, damaged, healed.mesh)
    return HealingTrial("wrong" if judgement.broken else "ready", seconds, judgement)


def heal_inputs(entry: Defective) -> HealInputs:
    """The request for an entry."""
    return HealInputs.model_validate({"mesh": ANY_MESH, **dict(entry.options)})


def judge_healing(entry: Defective, damaged: Mesh, result: Mesh) -> HealingJudgement:
    """Errors by the exact referee, number of pieces and handles, and the deviation from the healthy surface."""
    healthy = entry.healthy()
    proof = validate({"healed": result})
    broken = [finding.message for finding in proof.findings if finding.severity is Severity.ERROR]
    if not broken and (found := _shape(proof)) != (wanted := _shape(validate({"healed": healthy}))):
        broken.append(f"pieces and handles are {found} instead of {wanted}")
    deviation_mm = measure_deviation(healthy, result).maximum_mm
    if deviation_mm > (bound_mm := entry.bound_mm):
        broken.append(f"it is {deviation_mm:.3g} mm off the healthy surface, {bound_mm:.3g} mm are allowed")
    sound = np.intersect1d(_triangle_keys(healthy), _triangle_keys(damaged))
    kept = float(np.isin(sound, _triangle_keys(result)).mean()) if len(sound) else 1.0
    return HealingJudgement(tuple(broken), deviation_mm, kept)


def _shape(proof: Validation) -> tuple[int, int | None]:
    report = proof.meshes["healed"]
    return report.components, report.genus


def _triangle_keys(mesh: Mesh) -> NDArray[np.void]:
    """One value per face that is equal for equal places of the corners in float32, whichever comes first."""
    corners = mesh.triangles().astype(np.float32) + np.float32(0.0)  # no negative zeros
    order = np.lexsort((corners[:, :, 2], corners[:, :, 1], corners[:, :, 0]), axis=1)
    ordered = np.ascontiguousarray(np.take_along_axis(corners, order[:, :, None], axis=1).reshape(-1, 9))
    return ordered.view([("", np.void, 36)]).ravel()
