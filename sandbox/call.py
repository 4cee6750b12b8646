"""One child from spawn to result, for callers that just wait."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from core.errors import LimitError
from sandbox.limits import Limits
from sandbox.messages import Message
from sandbox.nursery import Nursery
from sandbox.overrun import find_overrun

WATCH_S = 0.25  # between looks at memory and clock


def call(
    nursery: Nursery,
    target: str,
    payload: Mapping[str, Any],
    limits: Limits,
    scratch: Path,
    listener: Callable[[Message], None] | None = None,
    readable: Iterable[Path] = (),
) -> dict[str, Any]:
    """Run `target` to its end and return what it returned; `listener` hears its events; `readable`: inputs outside `scratch`.

    Raises the IntegumentError the target raised, LimitError limit.memory | cpu_time | wall_time | file_size,
    InternalError child.crashed | child.raised | nursery.*."""
    overrun: LimitError | None = None
    with nursery.spawn(target, payload, limits, scratch, readable) as child:
        while (outcome := child.outcome()) is None:
            for event in child.events(WATCH_S):
                if listener is not None:
                    listener(event)
            if overrun is None and (overrun := find_overrun(child)) is not None:
                child.kill()
    if overrun is not None:
        raise overrun
    if outcome.error is not None:
        raise outcome.error
    return outcome.result or {}
