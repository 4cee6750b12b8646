"""What of the host's files a child may read: the Python it runs on, our own packages, and what its libraries look at.

Not the folder of data, not the settings, not another job's scratch, no home, no /proc but its own.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

SYSTEM = (
    *("/usr/lib", "/usr/lib64", "/lib", "/lib64", "/usr/share/zoneinfo", "/usr/share/fonts", "/usr/share/fontconfig"),
    *("/etc/ld.so.cache", "/etc/localtime", "/etc/fonts", "/etc/mime.types"),
    *("/proc/self", "/proc/cpuinfo", "/proc/meminfo", "/proc/sys/vm/overcommit_memory", "/sys/devices/system/cpu"),
    *("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random"),
)
CACHE_VARIABLES = ("NUMBA_CACHE_DIR", "MPLCONFIGDIR")
CACHES = ("numba", "matplotlib")  # below the user's folder for caches
WRITABLE = ("/dev/null",)
PACKAGE_FOLDERS = ("site-packages", "dist-packages")


def visible_files(target: str) -> list[Path]:
    """Files and folders that a child running `target` ("module:function") may read besides its scratch folder and its inputs."""
    package = target.partition(":")[0].partition(".")[0]
    return [*known_files(), *([] if package in sys.modules else _places_of_absent(package))]


@cache
def known_files() -> tuple[Path, ...]:
    """What all children of one nursery may read. The nursery asks once, when everything is loaded: in a child it would cost
    10 ms to touch every module."""
    found = [Path(place) for place in SYSTEM]
    found += [Path(prefix) for prefix in {sys.prefix, sys.exec_prefix, sys.base_prefix, sys.base_exec_prefix}]
    found += [Path(entry) for entry in sys.path if Path(entry).name in PACKAGE_FOLDERS]
    found += [Path(entry) for entry in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep) if entry]
    found += [Path(os.environ[name]) for name in CACHE_VARIABLES if os.environ.get(name)]
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    found += [caches / name for name in CACHES]
    for name, module in list(sys.modules.items()):
        if "." not in name:
            found += _places(module)
    return tuple(sorted(place for place in set(found) if not set(place.parents) & set(found)))


def _places(module: ModuleType) -> Iterator[Path]:
    """Of one top-level package or module, not of what lies beside it: that may be anything."""
    if getattr(module, "__name__", "") == "__main__":
        return
    if paths := getattr(module, "__path__", None):
        yield from map(Path, paths)
    elif file := getattr(module, "__file__", None):
        yield Path(file)


def _places_of_absent(package: str) -> list[Path]:
    spec = find_spec(package)
    if spec is None:
        return []
    return [Path(place) for place in spec.submodule_search_locations or ([spec.origin] if spec.origin else [])]
