"""The surfaces that are damaged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from core.mesh import Mesh
from subjects.body import body
from subjects.corpus import hand, head
from subjects.damage.places import Floats, nearest_vertex, usual_edge
from subjects.generated.revolved import ball
from subjects.generated.solid import block


@dataclass(frozen=True)
class Healthy:
    """A closed surface without fault. flap: a place where it is thin and folds when offset. bald: one with nothing fine around.

    reach_mm: radius of a large hole around the bald place. crease: direction in which a vertex of a sharp rim lies farthest.
    """

    name: str
    make: Callable[[], Mesh]
    flap: tuple[float, float, float]
    bald: tuple[float, float, float]
    reach_mm: float
    crease: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def mesh(self) -> Mesh:
        """The surface, made once."""
        return _made(self)

    def place(self, which: Literal["flap", "bald"]) -> Floats:
        """The vertex nearest to one of the two places, (3,) mm."""
        mesh = self.mesh()
        place: Floats = mesh.vertices[nearest_vertex(mesh, np.array(self.flap if which == "flap" else self.bald))]
        return place

    @property
    def edge_mm(self) -> float:
        """Median length of the edges."""
        return usual_edge(self.mesh())


@lru_cache(maxsize=8)
def _made(healthy: Healthy) -> Mesh:
    return healthy.make()


EAR, CROWN = (87.9, 724.0, 37.5), (0.0, 849.0, 70.0)
BODY = Healthy("body", body, EAR, (-10.0, 113.0, -70.0), 32.0)
HEAD = Healthy("head", head, EAR, CROWN, 32.0, (1.0, -10.0, 0.0))
HAND = Healthy("hand", hand, (496.0, 124.0, 268.0), (430.0, 171.0, 230.0), 18.0, (-1.0, -0.3, 0.3))
BALL = Healthy("ball", lambda: ball(30, 4), (30.0, 0.0, 0.0), (0.0, 0.0, 30.0), 14.0)
CUBE = Healthy("cube", lambda: block(40, 40, 40, 2.5), (20.0, 0.0, 20.0), (0.0, 0.0, 20.0), 12.0, (1.0, 0.3, 1.0))
