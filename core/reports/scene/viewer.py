"""The viewer a report carries: one script of ours, made by `make web` and put into the page as it is."""

from __future__ import annotations

import base64
import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from core.errors import InternalError

FOLDER = Path(__file__).parents[1] / "viewer"
ENDS_A_SCRIPT = ("</script", "<!--", "\r")  # would end it early, or be read as something else than was hashed


@dataclass(frozen=True, slots=True)
class Viewer:
    """script: its text. licences: of the libraries inside. policy: the source expression that lets this very script run."""

    script: str
    licences: str
    policy: str

    @property
    def version(self) -> str:
        """The first digits of the script's SHA-256; two that agree show the same."""
        return hashlib.sha256(self.script.encode()).hexdigest()[:12]


@cache
def report_viewer() -> Viewer:
    """Raises: InternalError `report.viewer_missing`, `report.viewer_unfit`."""
    try:
        script = (FOLDER / "viewer.js").read_text(encoding="utf-8")
        licences = (FOLDER / "licenses.md").read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise InternalError(
            "report.viewer_missing",
            f"the viewer of reports has not been built: {error.filename} is missing; `make web` builds it",
        ) from error
    if any(sign in text.lower() for sign in ENDS_A_SCRIPT for text in (script, licences)):
        raise InternalError("report.viewer_unfit", f"a file in {FOLDER} holds text that cannot stand in a page; build it anew")
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode("ascii")
    return Viewer(script, licences, f"'sha256-{digest}'")
