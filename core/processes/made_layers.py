"""Layers as made: the skin moved where it has to be, the shells, and what a report says of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.reports.figures.marked_areas import LIMITED, MISSED, MOVED, MarkedArea
from core.run import RunContext
from core.schema.finding import Finding
from core.schema.report import ThicknessReport
from core.schema.shells import ShellsInputs
from core.shells.moved_places import describe_move
from core.shells.nested_shells import Shell, create_shells
from core.shells.thickness import is_limited, is_on_target, measure_thickness
from core.shells.thin_places import check_depth
from core.shells.widen_skin import WidenedSkin, widen_skin

SHIFT_SHARE = 0.05  # of the progress bar


@dataclass(frozen=True, eq=False, slots=True)
class MadeLayers:
    """The skin to go on with, and the layers outside and inside of it, outermost first."""

    widened: WidenedSkin
    shells: tuple[Shell, ...]

    def surfaces(self) -> dict[str, Mesh]:
        """All by name, as they nest: layers around the skin, the skin, layers below it."""
        around = {shell.name: shell.mesh for shell in self.shells if shell.side == "outside"}
        below = {shell.name: shell.mesh for shell in self.shells if shell.side == "inside"}
        return {**around, "skin": self.widened.mesh, **below}


def make_layers(skin: Mesh, inputs: ShellsInputs, arrays: Mapping[str, NDArray[np.float64]], run: RunContext) -> MadeLayers:
    """Needs: a skin that `require_fit_skin` accepts, exact in float32; arrays: name -> (V,) mm that layers refer to.

    Raises: InputError `layer.*`, `region.*`, `skin.too_thin`, `shells.no_room`; InternalError `skin.shift_not_proven`.
    """
    stage = run.stage("skin", 0.0, SHIFT_SHARE)
    widened = stage.checkpoint(
        "skin: widened",
        lambda: widen_skin(skin, inputs, arrays, stage),
        *(skin, inputs.model_dump(mode="json", exclude={"skin"}), arrays),
    )
    return MadeLayers(widened, create_shells(widened.mesh, inputs, run.stage("shells", SHIFT_SHARE, 1.0), arrays))


def thickness_reports(made: MadeLayers, inputs: ShellsInputs) -> dict[str, ThicknessReport]:
    """How well each layer keeps its depth."""
    return {
        shell.name: measure_thickness(shell, layer.depth_mm, layer.depth_array)
        for shell, layer in zip(made.shells, inputs.layers, strict=True)
    }


def layer_notes(made: MadeLayers, inputs: ShellsInputs) -> tuple[tuple[dict[str, Any], ...], tuple[Finding, ...]]:
    """What was changed on the skin, and where it moved or a layer is off its depth."""
    changes, moved = describe_move(made.widened, inputs.skin_shift_mm)
    return changes, (*moved, *(finding for shell in made.shells for finding in check_depth(shell)))


def marked_areas(made: MadeLayers) -> dict[str, tuple[MarkedArea, ...]]:
    """What the figures paint on each surface: where the skin was moved, where a layer is off its depth and why."""
    moved = MarkedArea("skin.moved_outwards", "moved outwards", MOVED, made.widened.moved_mm > 0)
    areas: dict[str, tuple[MarkedArea, ...]] = {"skin": (moved,)}
    for shell in made.shells:
        limited, off = is_limited(shell), ~is_on_target(shell)
        areas[shell.name] = (
            MarkedArea("shells.depth_limited", "limited by anatomy", LIMITED, limited),
            MarkedArea("shells.depth_missed", "off its depth although there is room", MISSED, off & ~limited),
        )
    return areas
