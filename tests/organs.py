"""Five made-up organs that lie inside the body of `subjects.body`: ellipsoids, one of them inside another."""

from __future__ import annotations

from core.mesh import Mesh
from tests.solids import sphere

PLACES: dict[str, tuple[tuple[float, float, float], tuple[float, float, float]]] = {  # centre, half axes; mm, y up
    "brain": ((0.0, 765.0, 40.0), (48.0, 42.0, 55.0)),
    "ventricles": ((0.0, 765.0, 40.0), (14.0, 12.0, 20.0)),
    "heart": ((14.0, 420.0, 60.0), (42.0, 42.0, 28.0)),
    "left_lung": ((72.0, 440.0, 35.0), (28.0, 70.0, 40.0)),
    "right_lung": ((-60.0, 440.0, 35.0), (28.0, 70.0, 40.0)),
}


def organs(subdivisions: int = 3) -> dict[str, Mesh]:
    """By name; 8 faces, four times as many per subdivision. Heart and left lung cross."""
    made = {}
    for name, (centre, half_axes) in PLACES.items():
        ball = sphere(1.0, subdivisions)
        made[name] = Mesh.of(ball.vertices * half_axes + centre, ball.faces).rounded_to_float32()
    return made
