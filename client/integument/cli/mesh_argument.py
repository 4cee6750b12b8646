"""Meshes as they are typed: a file, or the link of one the server holds."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from integument.errors import ArgumentError

_HELD = re.compile(r"^/v1/(meshes/[0-9a-f-]{36}|jobs/[0-9a-f-]{36}/results/[\w.-]+)$")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_-]+")


def is_held(text: str) -> bool:
    """True for `/v1/meshes/{id}` and `/v1/jobs/{id}/results/{output}`."""
    return _HELD.match(text) is not None


def require_mesh(text: str) -> str:
    """The text, if it is a link or a readable file. Raises: ArgumentError before anything is started or sent."""
    if not is_held(text):
        try:
            with Path(text).open("rb"):
                pass
        except OSError as error:
            raise ArgumentError(f"cannot read the mesh {text}: {error.strerror or error}") from error
    return text


def name_meshes(texts: Sequence[str]) -> dict[str, str]:
    """A name for each mesh, from its file name, made unique with a number; in the order given."""
    named: dict[str, str] = {}
    for text in texts:
        last = Path(text).name if is_held(text) else Path(text).stem
        stem = _NOT_IN_NAMES.sub("_", last).lstrip("_-")[:60] or "mesh"
        name, number = stem, 2
        while name in named:
            name, number = f"{stem}_{number}", number + 1
        named[name] = text
    return named
