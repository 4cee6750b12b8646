"""When to start a crashed part again, and when to stop trying."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class RestartPolicy:
    """Waits of first_s, twice that, ... up to longest_s; gives up at the `crashes`-th crash within window_s."""

    first_s: float = 0.2
    longest_s: float = 10.0
    crashes: int = 5
    window_s: float = 60.0


@dataclass(slots=True)
class Backoff:
    """The crashes of one part within the window, times in seconds of a monotonic clock."""

    policy: RestartPolicy
    _crashed_at: deque[float] = field(default_factory=deque)

    def after_crash(self, now_s: float) -> float | None:
        """Seconds to wait before the next start; None: give up."""
        self._crashed_at.append(now_s)
        while self._crashed_at[0] < now_s - self.policy.window_s:
            self._crashed_at.popleft()
        if len(self._crashed_at) >= self.policy.crashes:
            return None
        return float(min(self.policy.first_s * 2 ** (len(self._crashed_at) - 1), self.policy.longest_s))
