"""The steps of one attempt: found among those kept before, or made and kept for the next attempt."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from core.processes.checkpoints.checkpoint_file import DamagedError, read, size_of, write
from core.processes.checkpoints.key import key_of
from core.processes.checkpoints.plain import Plain, from_plain, to_plain
from core.processes.processor_time import processor_s

logger = logging.getLogger(__name__)

SUFFIX = ".step"
T = TypeVar("T")


class KeptSteps:
    """What `core.run.RunContext.checkpoint` asks.

    generation: names the software; steps of another one are not found. kept: key -> file of an attempt before, read only.
    folder: where new files go; `tell(key, stage)` says that one is whole. worth_s: a step that took less processor time is
    not kept. room_bytes: files larger than what is left of it are not kept.
    """

    def __init__(
        self,
        generation: str,
        kept: Mapping[str, Path],
        folder: Path,
        tell: Callable[[str, str], None],
        *,
        worth_s: float,
        room_bytes: int,
    ) -> None:
        self._generation = generation
        self._kept = dict(kept)
        self._folder = folder
        self._tell = tell
        self._worth_s = worth_s
        self._room_bytes = room_bytes

    def step(self, stage: str, make: Callable[[], T], depends: tuple[object, ...], log: Callable[[str], None]) -> T:
        """The value, always as it is after being taken apart and put together: so both ways to it give the same bytes."""
        key = key_of(self._generation, stage, depends)
        if key in self._kept:
            try:
                value: T = from_plain(read(self._kept[key]))
            except (DamagedError, OSError, ValueError, TypeError, KeyError, AttributeError) as error:
                logger.warning("%s: what was kept of it cannot be used and is made again: %s", stage, error)
            else:
                log(f"{stage}: taken from the attempt before")
                return value
        began = processor_s()
        plain = to_plain(make())
        if processor_s() - began >= self._worth_s:
            self._keep(key, stage, plain)
        made: Any = from_plain(plain)
        restored: T = made
        return restored

    def _keep(self, key: str, stage: str, plain: Plain) -> None:
        """What cannot be kept is no reason to fail: another attempt makes it again."""
        if size_of(plain) > self._room_bytes:
            logger.warning("%s: %d bytes are not kept, there is room for %d", stage, size_of(plain), self._room_bytes)
            return
        path = self._folder / f"{key}{SUFFIX}"
        try:
            write(plain, path)
            self._room_bytes -= path.stat().st_size
        except OSError as error:
            logger.warning("%s: cannot be kept: %s", stage, error)
            return
        self._tell(key, stage)
