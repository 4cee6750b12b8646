"""Which software made a result."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import version
from pathlib import Path

from core.reports.scene.viewer import report_viewer

NAMED = ("integument-server", "libigl", "numba", "numpy", "scipy")
CORE = Path(__file__).parents[1]


@cache
def software_versions() -> dict[str, str]:
    """Distribution -> version, of all that decides about numbers; `report-viewer` shows them, its version is that of its text.

    Raises: InternalError `report.viewer_missing`, `report.viewer_unfit`.
    """
    return {**{name: version(name) for name in NAMED}, "report-viewer": report_viewer().version}


@cache
def software_digest() -> str:
    """SHA-256 over these versions and every source file of `core`: two that agree make the same bytes of the same input."""
    digest = hashlib.sha256(repr(sorted(software_versions().items())).encode())
    for path in sorted(CORE.rglob("*.py")):
        digest.update(f"{path.relative_to(CORE)} {path.stat().st_size}\n".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
