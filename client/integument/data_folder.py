"""The folder of the embedded server, seen from outside."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

import httpx

from integument.tls import tls_context

PROBE_TIMEOUT_S = 5.0


def default_data_dir() -> Path:
    """INTEGUMENT_DATA_DIR, else `$XDG_DATA_HOME/integument`, else `~/.local/share/integument`."""
    own = os.environ.get("INTEGUMENT_DATA_DIR")
    if own:
        return Path(own).expanduser().absolute()
    home = os.environ.get("XDG_DATA_HOME")
    return (Path(home) if home else Path.home() / ".local" / "share") / "integument"


@dataclass(frozen=True, slots=True)
class DataFolder:
    """Where a server keeps its data, and tells in `server.json` where it answers."""

    path: Path

    @property
    def log(self) -> Path:
        """What a server started for a call printed."""
        return self.path / "embedded.log"

    @property
    def clients_lock(self) -> Path:
        """Shared by all calls that use the server; a server started for a call waits for it exclusively, to stop then."""
        return self.path / "clients.lock"

    @property
    def count_lock(self) -> Path:
        """Shared by all calls too, but no server waits for it: here a call learns whether it is the last."""
        return self.path / "count.lock"

    @property
    def start_lock(self) -> Path:
        """Held by the one call that looks for a server, or starts it."""
        return self.path / "start.lock"

    def running_url(self) -> str | None:
        """Where a server answers that is ready for work; None if there is none (a killed one leaves its file behind)."""
        try:
            url = str(json.loads((self.path / "server.json").read_text(encoding="utf-8"))["url"])
        except (FileNotFoundError, ValueError, KeyError, TypeError):
            return None
        try:
            reply = httpx.get(f"{url}/readyz", timeout=PROBE_TIMEOUT_S, verify=tls_context(), trust_env=False)
        except httpx.HTTPError:
            return None
        return url if reply.is_success else None
