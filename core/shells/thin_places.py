"""Where a layer does not keep its depth: connected patches of the surface, largest first."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from core.geometry.adjacency import edges
from core.mesh import Mesh
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.shells.nested_shells import Shell
from core.shells.thickness import is_limited, is_on_target, vertex_areas


def check_depth(shell: Shell) -> list[Finding]:
    """Findings `shells.depth_limited` (anatomy allows no more) and `shells.depth_missed` (it would), with every patch."""
    limited = is_limited(shell)
    room = "the body is" if shell.side == "inside" else "the room around the body is"
    missed = ~is_on_target(shell) & ~limited
    return [
        *_finding(shell, limited, "shells.depth_limited", Severity.INFO, f"{room} too thin for its depth"),
        *_finding(shell, missed, "shells.depth_missed", Severity.WARNING, "its depth was not reached although there is room"),
    ]


def _finding(shell: Shell, chosen: NDArray[np.bool_], code: str, severity: Severity, why: str) -> list[Finding]:
    if not chosen.any():
        return []
    areas = vertex_areas(shell.mesh)
    patches = find_patches(shell.mesh, chosen, areas)
    share = 100 * float(areas[chosen].sum() / areas.sum())
    depths = shell.depth_mm[chosen]
    return [
        Finding(
            code=code,
            severity=severity,
            message=f"layer '{shell.name}': on {share:.2g} % of its area, in {len(patches)} places, {why}; "
            f"the depth there is {depths.min():.3g} to {depths.max():.3g} mm",
            count=len(patches),
            places=tuple(_place(shell, patch) for patch in patches[:MAX_PLACES]),
        )
    ]


def find_patches(mesh: Mesh, chosen: NDArray[np.bool_], areas: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """Chosen vertices grouped by the edges between them, by falling area and then number."""
    ends = edges(mesh.faces).ends
    inner = ends[chosen[ends].all(axis=1)]
    count = len(chosen)
    graph = coo_array((np.ones(len(inner), dtype=np.int8), (inner[:, 0], inner[:, 1])), shape=(count, count))
    _number, label = connected_components(graph, directed=False)
    members = np.flatnonzero(chosen)
    order = np.argsort(label[members], kind="stable")
    groups = np.split(members[order], np.flatnonzero(np.diff(label[members][order])) + 1)
    return sorted(groups, key=lambda group: (-float(areas[group].sum()), int(group[0])))


def _place(shell: Shell, patch: NDArray[np.int64]) -> Place:
    """The vertex furthest from its target stands for the patch."""
    worst = patch[np.argmax(np.abs(shell.depth_mm[patch] - shell.targets_mm[patch]))]
    x, y, z = (float(value) for value in shell.mesh.vertices[worst])
    return Place(mesh=shell.name, point_mm=(x, y, z), vertices=(int(worst),))
