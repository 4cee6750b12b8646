"""The jobs of a fault run: many kinds, all small, each with one right answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from core.mesh import Mesh
from tests.acceptance.service import binary_stl
from tests.solids import cube, sphere, together, torus, without_faces


@dataclass(frozen=True, slots=True)
class Variant:
    """A process and its inputs; `meshes` names what stands for `{href}` in them."""

    process: str
    inputs: Mapping[str, Any]
    mesh: str
    input_name: str

    def bound(self, href: str) -> dict[str, Any]:
        """The inputs with the reference to the uploaded mesh."""
        return {**self.inputs, self.input_name: {"href": href}}


@dataclass(frozen=True, slots=True)
class Request:
    """One job a client sends once, however often it has to say so: `key` is its Idempotency-Key."""

    number: int
    at_s: float
    client: int
    variant: int
    key: str
    dismissed_after_s: float | None


def make_meshes() -> dict[str, bytes]:
    """Binary STL by name."""
    meshes: dict[str, Mesh] = {
        "ball": sphere(60.0, 3),
        "pebble": sphere(25.0, 2),
        "globe": sphere(90.0, 4),
        "planet": sphere(80.0, 5),
        "ring": torus(60.0, 20.0, 40, 20),
        "box": cube(40.0),
        "cracked": without_faces(sphere(60.0, 3), [0, 1, 2, 100, 101]),
        "pair": together(sphere(30.0, 2), sphere(30.0, 2, (100.0, 0.0, 0.0))),
    }
    return {name: binary_stl(mesh) for name, mesh in meshes.items()}


def _layers(fat_mm: float, body_mm: float) -> dict[str, Any]:
    return {"layers": [{"name": "fat", "depth_mm": fat_mm}, {"name": "average_body", "depth_mm": body_mm}]}


ALL_MESHES = ("ball", "pebble", "globe", "planet", "ring", "box", "cracked", "pair")
STEPS = range(4)

VARIANTS: tuple[Variant, ...] = (
    *(Variant("validate", {}, mesh, "meshes") for mesh in ALL_MESHES),
    *(Variant("validate", {"min_gap_mm": gap}, mesh, "meshes") for mesh in ("ball", "ring") for gap in (0.05, 0.1, 0.2)),
    *(Variant("shells", _layers(1.0 + step / 4, 3.0 + step / 2), "ball", "skin") for step in STEPS),
    *(Variant("shells", _layers(1.0 + step / 4, 3.0 + step / 2), "globe", "skin") for step in STEPS),
    *(Variant("decimate", {"target_ratio": ratio}, "globe", "mesh") for ratio in (0.3, 0.5, 0.7)),
    Variant("decimate", {"target_ratio": 0.5}, "planet", "mesh"),
    Variant("heal", {}, "cracked", "mesh"),
    Variant("heal", {"pieces": "keep_all"}, "pair", "mesh"),
)
