"""Work for another thread while the network goes on, one thing at a time."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from starlette.concurrency import run_in_threadpool


class OneBehind:
    """Whoever starts the next thing waits for the one before, so nothing piles up."""

    def __init__(self) -> None:
        self._task: asyncio.Task[object] | None = None

    def start(self, work: Callable[[], object]) -> None:
        """After `done`."""
        self._task = asyncio.create_task(run_in_threadpool(work))

    async def done(self) -> None:
        """All is done. Raises what the work has raised."""
        if self._task is not None:
            await self._task

    async def over(self) -> None:
        """Nothing runs any more, well or not."""
        if self._task is not None:
            await asyncio.wait([self._task])
