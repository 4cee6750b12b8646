"""The header `Prefer` (RFC 7240), as far as this server honours it: `wait` and `respond-async`."""

from __future__ import annotations

import re
from dataclasses import dataclass

LONGEST_WAIT_S = 30
_WAIT = re.compile(r"wait\s*=\s*\"?(\d{1,6})\"?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Preferences:
    """What the client asked for, within what the server gives."""

    wait_s: int = 0
    respond_async: bool = False

    def applied(self) -> dict[str, str]:
        """The header `Preference-Applied` that tells the client what was honoured."""
        words = ["respond-async"] * self.respond_async + [f"wait={self.wait_s}"] * bool(self.wait_s)
        return {"Preference-Applied": ", ".join(words)} if words else {}


def read_preferences(lines: list[str]) -> Preferences:
    """Read all `Prefer` lines; what is not understood is ignored, as the RFC asks, and the first `wait` counts."""
    wait_s, respond_async = 0, False
    for preference in ",".join(lines).split(","):
        word = preference.split(";")[0].strip()
        if (match := _WAIT.fullmatch(word)) and not wait_s:
            wait_s = min(int(match.group(1)), LONGEST_WAIT_S)
        respond_async = respond_async or word.lower() == "respond-async"
    return Preferences(wait_s, respond_async)
