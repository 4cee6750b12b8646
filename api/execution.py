"""From the body of an execution request to an accepted job."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from api.process_documents import find_process
from api.schemas.execution import ExecuteRequest
from api.services import Services
from api.violations import ViolationsError
from core.errors import InputError
from core.schema.model import FrozenModel
from core.schema.processes import ProcessDescription
from core.schema.reference import CoilReference, FieldReference, MeshReference, PackageReference, VolumeReference
from core.schema.segment import SegmentInputs
from core.schema.surfaces import SurfacesInputs
from store.job import MeshInput
from store.workspace import WorkspaceId

_ORIGIN = re.compile(r"^https?://[^/]+")


def read_inputs(process: ProcessDescription, sent: Mapping[str, Any]) -> FrozenModel:
    """The inputs, validated. Raises ViolationsError `inputs.invalid`, `inputs.unknown_key`."""
    try:
        return process.inputs.model_validate(dict(sent))
    except ValidationError as error:
        raise ViolationsError("inputs.invalid", "inputs.unknown_key", error, base="/inputs", sent=sent) from None


def require_known_outputs(process: ProcessDescription, inputs: FrozenModel, request: ExecuteRequest) -> None:
    """Raises InputError `outputs.unknown` if the request names an output this job will not have."""
    if isinstance(inputs, SurfacesInputs) and inputs.package is not None:
        return  # which surfaces a package holds is known when it is read
    if isinstance(inputs, SegmentInputs) and inputs.includes_others:
        return  # and so are the labels of a volume
    known = [*process.outputs]
    if process.names_layers:
        known += [layer.name for layer in getattr(inputs, "layers", ())]
    if process.names_tissues:
        known += [tissue.name for tissue in getattr(inputs, "tissues", ())]
    if isinstance(inputs, SegmentInputs):
        known += inputs.names.values()
    if isinstance(inputs, SurfacesInputs):
        known = [name for name in known if name != ("mesh" if inputs.mesh is None else "package")]
        known += list(inputs.meshes or ())
    unknown = sorted(set(request.outputs or ()) - set(known))
    if unknown:
        raise InputError(
            "outputs.unknown", f"Process '{process.id}' has no output {', '.join(unknown)[:200]}; it has {', '.join(known)}"
        )


def resolve_meshes(services: Services, workspace: WorkspaceId, inputs: FrozenModel) -> tuple[dict[str, Any], list[MeshInput]]:
    """The inputs as stored (links without host: only their path counts) and the meshes they are bound to.

    Raises InputError `reference.*`."""
    wanted = dict.fromkeys((path_of(reference.href), type(reference)) for reference in references_in(inputs))
    of = services.mesh_inputs
    resolve: dict[type[MeshReference], Callable[[WorkspaceId, str], MeshInput]] = {
        PackageReference: of.resolve_package,
        VolumeReference: of.resolve_volume,
        FieldReference: of.resolve_field,
        CoilReference: of.resolve_coil,
    }
    meshes = [resolve.get(kind, of.resolve)(workspace, href) for href, kind in wanted]
    return _with_paths(_stored(inputs, inputs.model_dump(mode="json"))), meshes


def path_of(href: str) -> str:
    """A link without scheme and host."""
    return _ORIGIN.sub("", href)


def references_in(value: object) -> Iterator[MeshReference]:
    """Every reference to a mesh or package in validated inputs."""
    if isinstance(value, MeshReference):
        yield value
    elif isinstance(value, FrozenModel):
        for name in type(value).model_fields:
            yield from references_in(getattr(value, name))
    elif isinstance(value, Mapping):
        for item in value.values():
            yield from references_in(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from references_in(item)


def _stored(value: object, dumped: Any) -> Any:
    """What a model says in JSON, without the keys that are null and would be again; null where the default is another counts."""
    if isinstance(value, FrozenModel):
        fields = type(value).model_fields
        return {
            name: _stored(getattr(value, name), item)
            for name, item in dumped.items()
            if item is not None or fields[name].default is not None
        }
    if isinstance(value, Mapping):
        return {key: _stored(item, dumped[str(key)]) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_stored(item, one) for item, one in zip(value, dumped, strict=True)]
    return dumped


def _with_paths(value: Any) -> Any:
    if isinstance(value, dict):
        return {
            key: path_of(item) if key == "href" and isinstance(item, str) else _with_paths(item) for key, item in value.items()
        }
    if isinstance(value, list):
        return [_with_paths(item) for item in value]
    return value


def find_and_read(process_id: str, request: ExecuteRequest) -> tuple[ProcessDescription, FrozenModel]:
    """The process and its validated inputs. Raises StateError `process.not_found`, InputError `inputs.*`, `outputs.unknown`."""
    process = find_process(process_id)
    inputs = read_inputs(process, request.inputs)
    require_known_outputs(process, inputs, request)
    return process, inputs
