"""A stored mesh as a file in another format. Runs in the limited child, like everything that holds a mesh in memory."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from core.io import canonical
from core.io.registry import FORMATS, write_mesh
from core.reports.scene.thin_out import thin_out


def run(payload: dict[str, Any], channel: object) -> dict[str, Any]:
    """Write payload["path"] (canonical form) to payload["out_path"] as payload["format"], in mm, under payload["name"].

    payload["most_faces"]: above so many the mesh is thinned for the eye; None writes it as it is.
    Returns {"media_type", "extension"}. Raises: InputError `format.unknown`, InternalError `canonical.corrupt`."""
    del channel  # a file is written in seconds: there is no progress to tell
    chosen = str(payload["format"])
    mesh, most_faces = canonical.load(Path(payload["path"])), payload.get("most_faces")
    shown = mesh if most_faces is None else thin_out(mesh, int(most_faces))
    write_mesh(shown, Path(payload["out_path"]), chosen, payload["name"])
    known = FORMATS[chosen.partition("-")[0]]  # stl-ascii is stl to everybody who opens it
    return {"media_type": known.media_type, "extension": known.extensions[0]}
