"""Write openapi/openapi.json, or with --check say whether it still is what the application serves (exit code 1 if not)."""

from __future__ import annotations

import difflib
import sys
import tempfile
from pathlib import Path

from api.app import create_app
from api.openapi import openapi_bytes
from store.settings import Settings

TARGET = Path(__file__).parents[1] / "openapi" / "openapi.json"


def main(arguments: list[str]) -> int:
    """0 written or equal, 1 drifted, 2 unknown arguments."""
    if arguments not in ([], ["--check"]):
        print(f"usage: {Path(__file__).name} [--check]", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        current = openapi_bytes(create_app(Settings(data_dir=Path(folder))))
    if not arguments:
        TARGET.parent.mkdir(exist_ok=True)
        TARGET.write_bytes(current)
        return 0
    committed = TARGET.read_bytes() if TARGET.exists() else b""
    if committed == current:
        return 0
    lines = (text.decode().splitlines(keepends=True) for text in (committed, current))
    sys.stdout.writelines(difflib.unified_diff(*lines, "openapi/openapi.json", "the application"))
    print("openapi/openapi.json is not what the application serves; run scripts/openapi.py and look at the difference")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
