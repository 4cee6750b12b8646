"""Print the path of a uv that works, installing one below .uv/ when the machine has none. Standard library only.

Debian's bare python3 has neither pip nor venv, so the last resort unpacks uv's wheel from the package index itself.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import platform
import shutil
import subprocess
import sys
import urllib.request
import zipfile
from pathlib import Path
from urllib.parse import urljoin

HOME = Path(__file__).resolve().parent.parent / ".uv"
INDEX = os.environ.get("UV_BOOTSTRAP_INDEX", "https://pypi.org")
UV_REQUIREMENT = "uv>=0.8"


def works(candidate: str | None) -> bool:
    """True if the program answers `--version`."""
    return bool(candidate) and subprocess.run([str(candidate), "--version"], capture_output=True).returncode == 0


def install_with_pip() -> str | None:
    """A private virtual environment with uv in it."""
    made = subprocess.run([sys.executable, "-m", "venv", str(HOME)], capture_output=True)
    pip = HOME / "bin" / "pip"
    if made.returncode != 0 or not pip.exists():
        shutil.rmtree(HOME, ignore_errors=True)
        return None
    subprocess.run([str(pip), "install", "--quiet", "--disable-pip-version-check", UV_REQUIREMENT], check=True, stdout=sys.stderr)
    return str(HOME / "bin" / "uv")


def unpack_wheel() -> str:
    """uv's own wheel, checked against the index's sha256."""
    with urllib.request.urlopen(f"{INDEX}/pypi/uv/json") as reply:
        files, place = json.load(reply)["urls"], reply.url
    machine = platform.machine()
    wheel = next(f for f in files if f["filename"].endswith(f"manylinux_2_17_{machine}.manylinux2014_{machine}.whl"))
    # a mirror may answer with links relative to its own page
    with urllib.request.urlopen(urljoin(place, wheel["url"])) as reply:
        payload = reply.read()
    if hashlib.sha256(payload).hexdigest() != wheel["digests"]["sha256"]:
        sys.exit("the uv wheel does not match its published sha256")
    target = HOME / "bin" / "uv"
    target.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(io.BytesIO(payload)) as archive:
        member = next(name for name in archive.namelist() if name.endswith("/scripts/uv"))
        target.write_bytes(archive.read(member))
    target.chmod(0o755)
    return str(target)


def main() -> None:
    """Cheapest way first."""
    for candidate in (os.environ.get("UV"), shutil.which("uv"), str(HOME / "bin" / "uv")):
        if candidate and Path(candidate).exists() and works(candidate):
            print(candidate)
            return
    print(install_with_pip() or unpack_wheel())


if __name__ == "__main__":
    main()
