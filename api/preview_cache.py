"""Coarser meshes made for the eye, kept on this host: who looks at a job again does not wait for them again."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from uuid import uuid4

from api.version import SERVER_VERSION

UNFINISHED = ".part"


class PreviewCache:
    """Files by all that decides about their bytes; above `most_bytes` those not asked for the longest go. 0 keeps none.

    Losing it costs time only. Any number of processes may share the folder."""

    def __init__(self, folder: Path, most_bytes: int) -> None:
        self._folder = folder
        self._most_bytes = most_bytes

    def put_into(self, target: Path, make: Callable[[Path], None], *decides: object) -> None:
        """Have the file that `make` would write at `target`: a kept one, or a new one that is kept from now on.

        It is the caller's own from then on: that another process lets go of the kept one does not matter."""
        kept = self._folder / hashlib.sha256(json.dumps([SERVER_VERSION, *decides]).encode()).hexdigest()
        try:
            os.link(kept, target)
            os.utime(kept)
        except FileNotFoundError:
            make(target)
            self._keep(target, kept)

    def _keep(self, made: Path, kept: Path) -> None:
        if made.stat().st_size > self._most_bytes:
            return
        self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        # a copy: what a child wrote stays its caller's
        unfinished = self._folder / f"{uuid4().hex}{UNFINISHED}"
        try:
            shutil.copyfile(made, unfinished)
            unfinished.replace(kept)
        finally:
            unfinished.unlink(missing_ok=True)
        self._make_room()

    def _make_room(self) -> None:
        """Beside others that do the same: a file may be gone already."""
        found = []
        for path in self._folder.iterdir():
            try:
                found.append((path.stat(), path))
            except FileNotFoundError:
                continue
        total = 0
        for status, path in sorted(found, key=lambda each: -each[0].st_mtime):
            total += status.st_size
            if total > self._most_bytes:
                path.unlink(missing_ok=True)
