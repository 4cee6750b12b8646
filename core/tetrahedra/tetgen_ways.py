"""TetGen asked in several ways until one adds no vertex on a surface and is proven: which one does is luck of coordinates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.errors import InputError, InternalError
from core.tetrahedra.forked import Filling
from core.tetrahedra.tetgen import Facets, run_tetgen

T = TypeVar("T")
AXIS = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)  # along no plane of symmetry


@dataclass(frozen=True, slots=True)
class Way:
    """coplanar: how nearly in one plane faces must lie to be one facet to TetGen, relative. turned_deg: what it is given is
    turned so far about `AXIS` through its middle, and what it makes is turned back."""

    coplanar: float
    turned_deg: float = 0.0


# TetGen's own 1e-8 takes faces together that are bent by what float32 can tell, loses the edge between them, and can only put a
# vertex on the surface. No one number suits all; turned, another edge is the one it meets first.
WAYS = (Way(1e-12), Way(1e-8), Way(1e-16), Way(1e-12, 1.0), Way(1e-8, 1.0), Way(1e-12, 7.0))


def fill_facets(facets: Facets, switches: str, finish: Callable[[Filling], T]) -> T:
    """What `finish` makes of the tetrahedra, by the first way that works: YY among the switches ends TetGen if it has to add a
    vertex on a surface, and `finish` raises InternalError if they do not pass its proof.

    Raises: that of the last way: InputError `tetrahedra.refused` with what TetGen said, or what `finish` raised."""
    for way in WAYS[:-1]:
        try:
            return finish(_fill(facets, switches, way))
        except (InputError, InternalError):
            continue
    try:
        return finish(_fill(facets, switches, WAYS[-1]))
    except InputError as error:
        words = f"{error.message} That was the last of {len(WAYS)} ways to ask it."
        refused = InputError(error.code, words)
        refused.facts = error.facts
        raise refused from error


def _fill(facets: Facets, switches: str, way: Way) -> Filling:
    switches = f"{switches}T{way.coplanar:g}"
    if not way.turned_deg:
        return run_tetgen(facets, switches)
    turn = Rotation.from_rotvec(way.turned_deg * AXIS, degrees=True)
    middle = facets.vertices.mean(axis=0)
    turned = replace(facets, vertices=_turn(facets.vertices, turn, middle), points=_turn(facets.points, turn, middle))
    made = run_tetgen(turned, switches)
    nodes = _turn(made.nodes, turn.inv(), middle)
    nodes[: len(facets.vertices)] = facets.vertices  # bit for bit, not only turned back
    return replace(made, nodes=nodes)


def _turn(points: NDArray[np.float64], turn: Rotation, middle: NDArray[np.float64]) -> NDArray[np.float64]:
    turned: NDArray[np.float64] = turn.apply(points - middle) + middle
    return turned
