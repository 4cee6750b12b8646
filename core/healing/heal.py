"""From a defective surface to a closed one: a fixed sequence of small stages, each of which leaves a fit surface alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.healing.change import Change, Staged
from core.healing.fitness import find_faults
from core.mesh import Faces, Mesh, Vertices
from core.run import SILENT, RunContext
from core.schema.finding import Finding
from core.schema.heal import HealInputs

Ints = NDArray[np.int64]
Stage = Callable[[Vertices, Faces], Staged]

ROUNDS = 4  # mending one fault may lay open another


@dataclass(frozen=True, eq=False, slots=True)
class Healed:
    """The mended surface and what was done.

    former: (F,) face of the input with the same three corners at the same places, or -1. changes: plain facts, in the
    order in which they were made. findings: what a reader should know.
    """

    mesh: Mesh
    former: Ints
    changes: tuple[dict[str, Any], ...]
    findings: tuple[Finding, ...]


def heal(mesh: Mesh, inputs: HealInputs, run: RunContext = SILENT) -> Healed:
    """Mend a surface with the smallest change.

    Needs:    nothing of its shape.
    Promises: closed, edge- and vertex-manifold, outward, exactly free of self-intersection, coordinates exact in float32; faces
              away from faults keep their corners bit for bit; a fit surface comes back as it is; same input, same bytes.
    Raises:   InputError `heal.nothing_left`, `heal.one_sided`, `heal.hole_too_large`, `heal.holes_not_allowed`,
              `heal.changes_too_much`, `heal.not_resolved`.
    Source:   the stages name theirs."""
    raise InputError("heal.not_resolved", "not written yet")
