"""What is needed of Debian: Chromium for the web page, libraries for gmsh (the server's, too), programs of the docs' examples.

What is missing is installed as root.
"""

from __future__ import annotations

import ctypes.util
import os
import shutil
import subprocess
import sys

CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = ("chromium", "fonts-liberation")
PROGRAMS = {"curl": "curl", "jq": "jq", "octave-cli": "octave", "unzip": "unzip"}  # Octave runs what the pages show for MATLAB
GMSH_LIBRARIES = {
    "GLU": "libglu1-mesa",
    "gomp": "libgomp1",
    "Xft": "libxft2",
    "Xcursor": "libxcursor1",
    "Xinerama": "libxinerama1",
    "Xfixes": "libxfixes3",
}


def missing_packages() -> list[str]:
    """Names of Debian's packages."""
    browser = () if any(shutil.which(name) for name in CHROMIUM_NAMES) else CHROMIUM
    libraries = (package for library, package in GMSH_LIBRARIES.items() if ctypes.util.find_library(library) is None)
    programs = (package for program, package in PROGRAMS.items() if shutil.which(program) is None)
    return [*browser, *libraries, *programs]


def main() -> int:
    """Nothing to do, installed, or the command that installs it."""
    missing = missing_packages()
    if not missing:
        return 0
    install = ("apt-get", "install", "--yes", "--quiet", "--no-install-recommends", *missing)
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        print(f"The tests need {', '.join(missing)}: sudo {' '.join(install)}", file=sys.stderr)
        return 1
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    update = ("apt-get", "update", "--quiet")
    subprocess.run(update, env=environment, check=True, stdout=sys.stderr)
    return subprocess.run(install, env=environment, stdout=sys.stderr).returncode


if __name__ == "__main__":
    sys.exit(main())
