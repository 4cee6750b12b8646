"""Tissues of FreeSurfer's average head that touch and cross each other, as segmentation left them; each sound by itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache

from core.decimation.decimate import decimate
from core.healing.heal import heal
from core.mesh import Mesh
from core.schema.decimate import DecimateInputs
from core.schema.heal import HealInputs
from core.schema.reference import MeshReference
from core.schema.shells import Layer, ShellsInputs
from core.shells.nested_shells import create_shells
from subjects.fsaverage import brain, fsaverage

NOWHERE = MeshReference(href="/v1/meshes/00000000-0000-0000-0000-000000000000")
LAYERS = {"fat": 1.0, "average_body": 3.0, "outer_skull": 6.5}  # the last crosses the inner skull, 6.1 mm deep at its highest


RAW: Mapping[str, Callable[[], Mesh]] = {
    "skin": lambda: fsaverage("head"),
    "inner_skull": lambda: fsaverage("inner_skull-bem"),
    "grey_left": lambda: brain("pial", "left"),
    "white_left": lambda: brain("white", "left"),
    "grey_right": lambda: brain("pial", "right"),
    "white_right": lambda: brain("white", "right"),
}
FIVE = ("skin", "inner_skull", "grey_left", "white_left", "grey_right")


@lru_cache(maxsize=len(RAW))
def head_tissue(name: str) -> Mesh:
    """One of them, healed where it ran through itself. Raises: LookupError without the wheels."""
    return heal(RAW[name](), HealInputs(mesh=NOWHERE)).mesh.rounded_to_float32()


def head_tissues() -> dict[str, Mesh]:
    """Head, inner skull, and grey and white matter of both hemispheres: 106,462 faces.

    Grey and white coincide where there is no cortex, and cross there; the hemispheres touch.
    """
    return {name: head_tissue(name) for name in RAW}


def layered_head_tissues() -> dict[str, Mesh]:
    """The same with three layers below the skin: nine tissues, 118,648 faces."""
    tissues = head_tissues()
    layers = tuple(Layer(name=name, depth_mm=depth) for name, depth in LAYERS.items())
    shells = create_shells(tissues["skin"], ShellsInputs(skin=NOWHERE, layers=layers))
    return {"skin": tissues["skin"], **{shell.name: shell.mesh for shell in shells}, **tissues}


@lru_cache(maxsize=1)
def coarse_head_tissues(faces: int = 2000) -> Mapping[str, Mesh]:
    """Five of them with so few faces each that a test has time for them; thinned one by one, so they cross all the more."""
    inputs = DecimateInputs(mesh=NOWHERE, target_faces=faces)
    return {name: decimate({name: head_tissue(name)}, inputs)[name].mesh for name in FIVE}
