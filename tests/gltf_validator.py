"""The validator of the Khronos Group, which wrote glTF; it comes with the page's modules (`make web`)."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from scripts.web import MODULES, node

SCRIPT = Path(__file__).with_name("validate_glb.mjs")


def find_gltf_issues(path: Path) -> list[str]:
    """Codes of errors, warnings, notes and hints."""
    if not (MODULES / "gltf-validator").is_dir():
        pytest.fail("gltf-validator is missing: `make web` installs it")
    done = subprocess.run([node(), str(SCRIPT), str(MODULES.parent), str(path)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    told: dict[str, Any] = json.loads(done.stdout)
    return [message["code"] for message in told["issues"]["messages"]]
