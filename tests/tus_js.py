"""tus-js-client, the client browsers and Node.js use, run as it is; it comes with the page's modules (`make web`)."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from scripts.web import MODULES, node

SCRIPT = Path(__file__).parent / "api" / "tus_client.mjs"


def start_tus_js(endpoint: str, file: Path, memory: Path, **given: Any) -> subprocess.Popen[str]:
    """Begin to send `file`, or go on with what `memory` tells of an earlier run."""
    if not (MODULES / "tus-js-client").is_dir():
        pytest.fail("tus-js-client is missing: `make web` installs it")
    asked = {"modules": str(MODULES.parent), "endpoint": endpoint, "file": str(file), "memory": str(memory), **given}
    return subprocess.Popen([node(), str(SCRIPT), json.dumps(asked)], stdout=subprocess.PIPE, text=True)


def run_tus_js(endpoint: str, file: Path, memory: Path, **given: Any) -> dict[str, Any]:
    """To its end; what it says of it."""
    return told_by(start_tus_js(endpoint, file, memory, **given))


def told_by(process: subprocess.Popen[str]) -> dict[str, Any]:
    """The last words of a run."""
    out, _ = process.communicate(timeout=120)
    told: dict[str, Any] = json.loads(out.splitlines()[-1])
    return told
