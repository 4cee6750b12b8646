"""What a package may be made of."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from core.errors import InternalError
from core.package.tissue import FREE_SPACE, Tissue

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")


def require_packable(tissues: Sequence[Tissue]) -> None:
    """Raises: InternalError `package.name_refused` unless names are plain and differ in more than case;
    `package.not_nested` unless every tissue but the first comes after the one that encloses it;
    `package.not_rounded` unless every coordinate is a float32 value, so that STL and MAT hold the same."""
    seen: dict[str, str] = {}
    for tissue in tissues:
        if not NAME.fullmatch(tissue.name) or tissue.name.lower() in {*seen, FREE_SPACE.lower()}:
            raise InternalError(
                "package.name_refused", f"{tissue.name!r} cannot name a file, or twice the same one", name=tissue.name
            )
        if tissue.enclosing not in ({FREE_SPACE} | set(seen.values())):
            raise InternalError(
                "package.not_nested",
                f"'{tissue.name}' is listed before '{tissue.enclosing}', which encloses it",
                name=tissue.name,
            )
        moved = int((tissue.mesh.vertices != tissue.mesh.vertices.astype(np.float32)).any(axis=1).sum())
        if moved:
            raise InternalError(
                "package.not_rounded",
                f"{moved} vertices of '{tissue.name}' are not float32 values: what was proven is not what STL would hold",
                name=tissue.name,
                vertices=moved,
            )
        seen[tissue.name.lower()] = tissue.name
