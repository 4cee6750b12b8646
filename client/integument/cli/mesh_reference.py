"""From a mesh on the command line to the link a job takes."""

from __future__ import annotations

from pathlib import Path

from integument.cli.mesh_argument import is_held
from integument.cli.progress import ProgressView
from integument.cli.session import Session
from integument.surface_processes import Unit


def refer_to(session: Session, view: ProgressView, mesh: str, unit: Unit) -> dict[str, str]:
    """A link as it is; a file is uploaded, with progress, and what is odd about it is told before anything is built on it."""
    if is_held(mesh):
        return {"href": mesh}
    on_bytes = view.transfer(f"upload {Path(mesh).name}")
    sent = session.client.upload_mesh(mesh, unit=unit, on_bytes=on_bytes)
    for finding in sent.findings:
        view.on_finding(finding)
    return {"href": sent.href}
