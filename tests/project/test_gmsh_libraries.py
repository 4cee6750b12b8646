"""What gmsh is linked with is in the image, in its own message, in what `make test` asks for, and on the page."""

import re
import shlex
from importlib.metadata import files
from pathlib import Path

from core.tetrahedra.gmsh import DEBIAN_PACKAGES
from scripts.debian_packages import GMSH_LIBRARIES
from tests.project.sources import ROOT

BROUGHT = {
    "GL": "libgl1",
    "GLU": "libglu1-mesa",
    "X11": "libxft2",  # Debian's packages bring what they need themselves
    "Xcursor": "libxcursor1",
    "Xext": "libxinerama1",
    "Xfixes": "libxfixes3",
    "Xft": "libxft2",
    "Xinerama": "libxinerama1",
    "Xrender": "libxft2",
    "fontconfig": "libfontconfig1",
    "gomp": "libgomp1",
}
IN_EVERY_IMAGE = {"c", "dl", "gcc_s", "m", "pthread", "rt", "stdc++", "z"}
LOADED_IF_THERE = {"Xrandr", "glib-2.0", "gtk-3", "gtk-x11-2.0"}  # by its windows, which nobody opens here


def test_every_library_gmsh_names_is_brought_by_a_package_of_the_image() -> None:
    (library,) = {Path(str(file.locate())).resolve() for file in files("gmsh") or () if file.name.startswith("libgmsh.so")}
    named = {name.decode() for name in re.findall(rb"\0lib([\w+.-]{1,40}?)\.so\.\d+(?=\0)", library.read_bytes())}
    assert named - IN_EVERY_IMAGE - LOADED_IF_THERE == set(BROUGHT)
    text = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
    (install,) = re.findall(r"apt-get install (.*?) *&&", text)
    assert set(BROUGHT.values()) == {word for word in shlex.split(install) if not word.startswith("-")}


def test_whoever_lacks_one_is_told_the_same_packages_everywhere() -> None:
    assert set(DEBIAN_PACKAGES.split()) == set(GMSH_LIBRARIES.values()) <= set(BROUGHT.values())
    assert DEBIAN_PACKAGES in (ROOT / "docs" / "processes" / "tetrahedralize.md").read_text()
