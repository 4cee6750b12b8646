"""A file a child hands over by name. The child has read untrusted bytes, so the name is not taken on trust."""

from __future__ import annotations

import stat
from pathlib import Path

from sandbox.outcome import protocol_broken


def require_own_file(folder: Path, told: str, what: str) -> Path:
    """The path `told`, if it is a plain file inside `folder` and no link leads out of it; the child must be dead.

    Raises InternalError `child.protocol_broken`."""
    root = folder.resolve()
    path = root / told
    try:
        plain = stat.S_ISREG(path.lstat().st_mode) and path.resolve(strict=True).is_relative_to(root)
    except (OSError, ValueError) as error:  # the latter: a path with a zero byte
        raise protocol_broken(f"{what}: {error}") from error
    if not plain:
        raise protocol_broken(f"{what} is no file of this child")
    return path
