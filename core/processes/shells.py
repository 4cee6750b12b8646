"""The process `shells`: nested layers below a skin, proven on the files that are delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.processes.layer_package import LayerJob, deliver_layers
from core.processes.loaded_skin import load_skin
from core.processes.outcome import Outcome
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.run import RunContext
from core.schema.shells import ShellsInputs

OUTSIDE = (
    "The layers outside the skin were made in the same way with the faces of the skin turned over, so that the room around the "
    "body took the place of the body. "
)
MOVED = (
    "Where the inner medial ball [4] is too small for the deepest layer, the skin was first moved outwards by up to "
    "{bound:g} mm, as [3] (5.2.3) did by hand; elsewhere its vertices were left as they are. "
)
METHODS = (
    "Every layer was made from the skin by nodal movement along the inward direction that shifts all adjacent faces equally, "
    "the generalised form of Eq. (4.1) of [3]. The depth follows the request and fades smoothly where the inner medial ball [4] "
    "leaves no room. Starting from the thinnest stack of layers that keeps the gap, the deepest layer was placed first; each "
    "state on the way kept {gap:g} mm to its neighbours. Coordinates were rounded to single precision, written to binary STL, "
    "read back, and proven there with exact predicates [1]: closed, manifold, outward, nested and without any intersection."
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] A. T. Htet, Full-body Shell Creation for CAD Virtual Humans including Tightly-Spaced, Enclosed Shells, "
    "Worcester Polytechnic Institute",
    "[4] J. Ma, S. W. Bae, S. Choi, 3D medial axis point approximation using nearest neighbors and the normal field, "
    "The Visual Computer 28, 2012, doi:10.1007/s00371-011-0594-7",
)


def methods_text(inputs: ShellsInputs) -> str:
    """What was done for these inputs, to cite."""
    outside = any(layer.side == "outside" for layer in inputs.layers)
    moved = MOVED.format(bound=inputs.skin_shift_mm) if inputs.skin_shift_mm else ""
    return moved + (OUTSIDE if outside else "") + METHODS.format(gap=inputs.min_gap_mm)


def run_shells(inputs: ShellsInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Layers, proof on the files, report and package.

    Raises: InputError `skin.*`, `layer.*`, `region.*`, `shells.no_room`; InternalError `shells.not_proven` with a report.
    """
    source = load_skin(inputs.skin.href, meshes, run)
    job = LayerJob(
        process="shells",
        skin=source.mesh,
        inputs=inputs,
        methods=methods_text(inputs),
        references=REFERENCES,
        parameters={
            **inputs.model_dump(mode="json", exclude={"skin"}),
            "skin": {"name": source.name, "sha256": source.sha256},
        },
        changes=source.changes,
        arrays=source.arrays,
    )
    return deliver_layers(job, run.stage("shells", 0.06, 1.0), out_dir)
