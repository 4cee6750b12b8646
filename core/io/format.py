"""What the registry knows of a format."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from core.io.reading import Reading
from core.mesh import Mesh

Reader = Callable[[Path], Reading]
Writer = Callable[[Mesh, Path, str], None]


@dataclass(frozen=True, slots=True)
class Format:
    """extensions with their dot, the usual one first. `write(mesh, path, name)` is deterministic and writes millimetres."""

    extensions: tuple[str, ...]
    media_type: str
    read: Reader
    write: Writer
