"""A stored mesh as a file in another format. Runs in the limited child, like everything that holds a mesh in memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.io.registry import write_mesh
from core.processes.named_input import load_input
from core.reports.scene.thin_out import thin_out


def run(payload: dict[str, Any], channel: object) -> dict[str, Any]:
    """Write payload["path"] to payload["out_path"] as payload["format"], in mm, under payload["name"].

    payload["media_type"], ["file_name"]: of the stored file, the canonical form of an upload or a mesh that a job made.
    payload["most_faces"]: above so many the mesh is thinned for the eye; None writes it as it is.
    Returns {"faces"}: how many were written.
    Raises: InputError `format.unknown`, InternalError `canonical.corrupt`."""
    del channel  # a file is written in seconds: there is no progress to tell
    path, most_faces = payload["path"], payload.get("most_faces")
    mesh = load_input(path, {path: {**payload, "sha256": ""}}).mesh
    shown = mesh if most_faces is None else thin_out(mesh, int(most_faces))
    write_mesh(shown, Path(payload["out_path"]), str(payload["format"]), payload["name"])
    return {"faces": len(shown.faces)}
