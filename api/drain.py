"""The moment the server begins to stop: streams and long polls end, so that nothing holds the shutdown up."""

from __future__ import annotations

import anyio


class Drain:
    """Set once, from the signal handler; everybody who waits looks at it."""

    def __init__(self) -> None:
        self._begun = False

    @property
    def begun(self) -> bool:
        """True once the server stops."""
        return self._begun

    def begin(self) -> None:
        """Only a flag, so a signal handler may call it."""
        self._begun = True

    async def pause(self, seconds: float, step_s: float = 0.1) -> None:
        """Sleep, but not beyond the beginning of the drain by more than `step_s`."""
        while seconds > 0 and not self._begun:
            await anyio.sleep(min(step_s, seconds))
            seconds -= step_s
