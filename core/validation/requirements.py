"""What an algorithm may ask of its input; a failure is the input's, with the places to look at."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from core.errors import InputError
from core.mesh import Mesh
from core.schema.finding import Finding, Severity
from core.validation.closed import check_closed
from core.validation.components import check_components
from core.validation.faces import check_degenerate_faces, check_duplicate_faces
from core.validation.manifold import check_edge_manifold, check_vertex_manifold
from core.validation.orientation import check_orientation, check_outward
from core.validation.self_intersection import check_self_intersection
from core.validation.surface import Surface
from core.validation.vertices import check_coincident_vertices

Check: TypeAlias = Callable[[Surface], list[Finding]]
Wanted: TypeAlias = tuple[str, tuple[Check, ...]]

_SOUND: tuple[Wanted, ...] = (
    ("surface.degenerate", (check_degenerate_faces,)),
    ("surface.not_manifold", (check_duplicate_faces, check_edge_manifold, check_vertex_manifold)),
)
_CLOSED: Wanted = ("surface.not_closed", (check_closed,))
_ORIENTED: Wanted = ("surface.not_oriented", (check_orientation,))
_OUTWARD: Wanted = ("surface.inside_out", (check_outward,))
_APART_FROM_ITSELF: tuple[Wanted, ...] = (
    ("surface.self_touching", (check_coincident_vertices,)),
    ("surface.self_intersecting", (check_self_intersection,)),
)

_CLOSED_SKIN: tuple[Wanted, ...] = (
    ("skin.degenerate", (check_degenerate_faces,)),
    ("skin.not_manifold", (check_duplicate_faces, check_edge_manifold, check_vertex_manifold)),
    ("skin.not_closed", (check_closed,)),
    ("skin.not_oriented", (check_orientation,)),
    ("skin.inside_out", (check_outward,)),
    ("skin.several_bodies", (check_components,)),
    ("skin.self_touching", (check_coincident_vertices,)),
)

HINT = "Mend it with the process `heal`, or in the program it comes from"


def require_closed_skin(mesh: Mesh, name: str) -> None:
    """Ask for one closed, manifold, outward surface, which may run through itself.

    Raises: InputError as `require_fit_skin`, but for `skin.self_intersecting`.
    """
    _require(Surface(name, mesh), *_CLOSED_SKIN)


def require_fit_skin(mesh: Mesh, name: str) -> None:
    """Ask for one closed, manifold, outward surface that does not run through itself.

    Raises: InputError with the findings of all checks that failed and the code of the first of them, in this order:
    `skin.degenerate`, `skin.not_manifold`, `skin.not_closed`, `skin.not_oriented`, `skin.inside_out`,
    `skin.several_bodies`, `skin.self_touching`, `skin.self_intersecting`.
    """
    _require(Surface(name, mesh), *_CLOSED_SKIN, ("skin.self_intersecting", (check_self_intersection,)))


def require_sound_surface(mesh: Mesh, name: str) -> None:
    """Ask for a manifold, consistently oriented surface, open or closed, that does not run through itself.

    Raises: InputError with the findings of all checks that failed and the code of the first of them, in this order:
    `surface.degenerate`, `surface.not_manifold`, `surface.not_oriented`, `surface.self_touching`, `surface.self_intersecting`.
    """
    _require(Surface(name, mesh), *_SOUND, _ORIENTED, *_APART_FROM_ITSELF)


def require_closed_surface(mesh: Mesh, name: str) -> None:
    """Ask for closed, manifold, consistently oriented surfaces, one or several, that do not run through themselves.

    Raises: InputError with the findings of all checks that failed and the code of the first of them, in this order:
    `surface.degenerate`, `surface.not_manifold`, `surface.not_closed`, `surface.not_oriented`, `surface.self_touching`,
    `surface.self_intersecting`.
    """
    _require(Surface(name, mesh), *_SOUND, _CLOSED, _ORIENTED, *_APART_FROM_ITSELF)


def require_outward_surface(mesh: Mesh, name: str) -> None:
    """As `require_closed_surface`, and its pieces look outward, its cavities into the hollow.

    Raises: InputError as there, and before `surface.self_touching` `surface.inside_out`.
    """
    _require(Surface(name, mesh), *_SOUND, _CLOSED, _ORIENTED, _OUTWARD, *_APART_FROM_ITSELF)


def _require(surface: Surface, *wanted: Wanted) -> None:
    """Run checks, all of them; the code of the first that fails is raised."""
    failed: list[tuple[str, Finding]] = []
    for code, checks in wanted:
        # several pieces are no fault of a mesh, but one of a skin
        failed += [
            (code, finding.model_copy(update={"severity": Severity.ERROR})) for check in checks for finding in check(surface)
        ]
    if not failed:
        return
    code, first = failed[0]
    findings = tuple(finding for _code, finding in failed)
    raise InputError(
        code,
        f"{first.message}. {HINT}",
        findings=findings,
        count=first.count,
        failed_checks=len(failed),
    )
