"""Make sure that there is a Chromium for the browser tests: one on PATH, else Debian's, installed as root."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

NAMES = ("chromium", "chromium-browser", "google-chrome")
INSTALL = ("apt-get", "install", "--yes", "--quiet", "--no-install-recommends", "chromium", "fonts-liberation")


def main() -> int:
    """Nothing to do, installed, or the command that installs it."""
    if any(shutil.which(name) for name in NAMES):
        return 0
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        print(f"The browser tests need Chromium: sudo {' '.join(INSTALL)}", file=sys.stderr)
        return 1
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    update = ("apt-get", "update", "--quiet")
    subprocess.run(update, env=environment, check=True, stdout=sys.stderr)
    return subprocess.run(INSTALL, env=environment, stdout=sys.stderr).returncode


if __name__ == "__main__":
    sys.exit(main())
