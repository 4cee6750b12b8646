"""The field of a job as it is looked at. Runs in the limited child, like everything that holds a mesh in memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.package.field_preview import write_preview


def run(payload: dict[str, Any], channel: object) -> dict[str, Any]:
    """Write the .msh of a field at payload["path"] to payload["out_path"], with payload["most_faces"] triangles at most."""
    del channel  # a file is written in seconds: there is no progress to tell
    write_preview(Path(payload["path"]), Path(payload["out_path"]), int(payload["most_faces"]))
    return {}
