"""From a received file to a mesh the server holds: parsed in a limited child, then stored, or nothing at all."""

from __future__ import annotations

from pathlib import Path, PurePath
from typing import Any

from api.services import Services
from api.upload_form import ReceivedFile
from core.errors import InputError
from sandbox.call import call
from sandbox.handed_file import require_own_file
from sandbox.limits import Limits
from store.meshes import MeshRecord, MeshUpload

TARGET = "core.processes.intake:run"
UNITS = ("m", "cm", "mm", "in")
DEFAULT_UNIT = "mm"
MAX_NAME = 100


def limits_of(services: Services) -> Limits:
    """What one child that reads or writes a mesh file may use."""
    settings = services.settings
    return Limits(
        memory_bytes=settings.intake_memory_bytes,
        cpu_s=max(1, int(settings.intake_wall_s)),
        file_bytes=settings.job_file_bytes,
        wall_s=settings.intake_wall_s,
    )


def require_unit(received: ReceivedFile) -> str:
    """The unit of the form, millimetres if it names none. Raises InputError `unit.unknown`."""
    unit = received.fields.get("unit", DEFAULT_UNIT)
    if unit not in UNITS:
        raise InputError("unit.unknown", f"Unit {unit[:20]!r} is not known; use one of {', '.join(UNITS)}")
    return unit


def require_mesh(record: MeshRecord) -> None:
    """Raises InputError `mesh.is_a_volume`, `mesh.is_a_field`, `mesh.is_a_coil` if the upload is no surface."""
    if record.volume is not None:
        raise InputError(
            "mesh.is_a_volume", f"'{record.name}' is a label volume, not a mesh; `segment` makes surfaces of it", mesh=record.id
        )
    if record.field is not None:
        raise InputError(
            "mesh.is_a_field", f"'{record.name}' is a field, not a mesh; `fields` brings it onto surfaces", mesh=record.id
        )
    if record.coil is not None:
        raise InputError(
            "mesh.is_a_coil", f"'{record.name}' is a coil, not a mesh; `fields` draws it beside surfaces", mesh=record.id
        )


def name_of(received: ReceivedFile) -> str:
    """The name the mesh shall have: that of the form, else that of the file."""
    told = received.fields.get("name", "") or PurePath(received.file_name).stem
    printable = "".join(character if character.isprintable() else " " for character in told)
    return " ".join(printable.split())[:MAX_NAME] or "mesh"


def parse(services: Services, received: ReceivedFile, unit: str, folder: Path) -> MeshUpload:
    """Read the file in a child that may not use more than its limits; `folder` is its scratch space.

    Raises what `core.processes.intake` raises, LimitError `limit.*`, InternalError `child.*`, `nursery.*`."""
    payload = {"path": str(received.path), "file_name": received.file_name, "unit": unit, "out_dir": str(folder)}
    told = call(services.nursery, TARGET, payload, limits_of(services), folder, readable=[received.path])
    mesh: dict[str, Any] = told["meshes"][0]
    x, y, z = mesh["extents_mm"]
    return MeshUpload(
        path=received.path,
        canonical_path=require_own_file(folder, str(mesh["path"]), "the mesh"),
        name=name_of(received),
        file_name=received.file_name,
        unit=unit,
        format=told["format"],
        vertices=mesh["vertices"],
        faces=mesh["faces"],
        extents_mm=(x, y, z),
        findings=tuple(told["findings"]),
        arrays=tuple(mesh["arrays"]),
        volume=told.get("volume"),
        field=told.get("field"),
        coil=told.get("coil"),
    )
