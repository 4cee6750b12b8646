"""One kind of change that a stage made: how many, where, how far."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mesh import Faces, Vertices
from core.validation.measure import significant
from core.validation.places import point_of

Floats = NDArray[np.float64]
Triangles = NDArray[np.float64]

MAX_LISTED = 1000  # places of one change in a report, the farthest first; `count` says how many there are


def no_triangles() -> Triangles:
    """(0, 3, 3)."""
    return np.empty((0, 3, 3))


@dataclass(frozen=True, eq=False, slots=True)
class Change:
    """What a stage did.

    kind: a noun with underscores, such as `holes`. message: one sentence with numbers. points: (K, 3) mm, one per place.
    distances: (K,) mm, how far the surface moved there. taken, added: (N, 3, 3) mm, triangles that the stage took away
    on purpose (pieces, fins, inner walls) and patches over holes, which the limit of the deviation does not count.
    """

    kind: str
    message: str
    points: Floats
    distances: Floats
    taken: Triangles = field(default_factory=no_triangles)
    added: Triangles = field(default_factory=no_triangles)

    def facts(self) -> dict[str, Any]:
        """Plain JSON for the report."""
        farthest = np.argsort(-self.distances, kind="stable")[:MAX_LISTED]
        return {
            "kind": self.kind,
            "message": self.message,
            "count": len(self.points),
            "max_distance_mm": significant(float(self.distances.max(initial=0.0))),
            "places": [
                {"point_mm": point_of(self.points[place]), "distance_mm": significant(float(self.distances[place]))}
                for place in farthest
            ],
        }


Staged = tuple[Vertices, Faces, list[Change]]  # what every stage returns
