"""A cohort out of one archive, sent in a form or as an upload in pieces: its settings come beside it, a file is a subject."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from pydantic import ValidationError

from api.archive import TakenArchive, take_archive
from api.cohort_request import accept_cohort, find_cohort, put_together, read_cohort, subject_target, validated
from api.idempotency import Once, fingerprint_of
from api.intake import require_unit
from api.links import BASE, mesh_path, upload_path
from api.locked_upload import locked_upload
from api.process_documents import find_process
from api.schemas.cohort import ArchiveSettings, CohortFromUpload, SubjectRequest
from api.services import Services
from api.upload_form import ReceivedFile
from api.violations import ViolationsError
from core.errors import InputError
from core.schema.cohort import takes_volume
from core.schema.reference import MeshReference
from store.callback import Subscriber
from store.cohort import Cohort
from store.cohorts import NewCohort
from store.workspace import WorkspaceId

FIELD = "cohort"  # of the form
FIELD_BYTES = 32 * 1024


def read_settings(received: ReceivedFile) -> ArchiveSettings:
    """Raises InputError `upload.field_missing`, `request.malformed`, ViolationsError `request.invalid`."""
    if FIELD not in received.fields:
        raise InputError("upload.field_missing", f"The form has no field '{FIELD}' with the process and its inputs")
    try:
        sent = json.loads(received.fields[FIELD])
    except (ValueError, RecursionError) as error:
        raise InputError("request.malformed", f"The field '{FIELD}' is no JSON: {error}") from error
    try:
        return ArchiveSettings.model_validate(sent)
    except ValidationError as error:
        raise ViolationsError("request.invalid", "request.invalid", error, base="", sent=sent) from None


def cohort_of_form(
    services: Services,
    workspace: WorkspaceId,
    received: ReceivedFile,
    settings: ArchiveSettings,
    subscriber: Subscriber | None,
    key: str | None,
) -> tuple[Cohort, bool]:
    """The cohort, and whether an earlier request with this key made it. If it is refused, none of its meshes is kept.

    Raises as `take_archive` and `read_cohort`, InputError `cohort.subject_unknown`."""
    told = {"file": received.sha256, "unit": require_unit(received), FIELD: settings.model_dump(mode="json")}
    once = Once(services, workspace, key, fingerprint_of("POST", f"{BASE}/cohort-archives", told))

    def take_in() -> Cohort:
        with _subjects_of_archive(services, workspace, received, settings, subscriber, received.path.parent) as new:
            return accept_cohort(services, workspace, new, once)

    return once.answer(take_in, partial(find_cohort, services, workspace))


def cohort_of_upload(
    services: Services,
    workspace: WorkspaceId,
    upload_id: str,
    wanted: CohortFromUpload,
    subscriber: Subscriber | None,
    key: str | None,
) -> tuple[Cohort, bool]:
    """The same of a finished upload, which goes in the transaction that makes the cohort; if it is refused it stays as it is.

    Raises also StateError `upload.*`."""
    once = Once(
        services, workspace, key, fingerprint_of("POST", f"{upload_path(upload_id)}/cohort", wanted.model_dump(mode="json"))
    )

    def take_in() -> Cohort:
        with locked_upload(services, workspace, upload_id) as locked:
            received = locked.read({} if wanted.unit is None else {"unit": wanted.unit})
            size, folder = received.size, locked.folder
            with _subjects_of_archive(services, workspace, received, wanted, subscriber, folder, reserved_bytes=size) as new:
                spend = partial(services.uploads.delete, workspace, upload_id)
                cohort = accept_cohort(services, workspace, new, once, also=lambda session: spend(session=session))
            locked.forget()
            return cohort

    return once.answer(take_in, partial(find_cohort, services, workspace))


@contextmanager
def _subjects_of_archive(
    services: Services,
    workspace: WorkspaceId,
    received: ReceivedFile,
    settings: ArchiveSettings,
    subscriber: Subscriber | None,
    folder: Path,
    *,
    reserved_bytes: int = 0,
) -> Iterator[NewCohort]:
    """The request for a cohort of what the archive holds; the meshes taken from it are kept if the block ends well.

    `folder` is scratch space."""
    [any_subject] = put_together(settings, [SubjectRequest(mesh=_ANY)])
    process = find_process(settings.process)
    if not settings.subjects:  # what is wrong for all is told before hundreds of files are read
        validated(process, any_subject)
    volumes = takes_volume(process.inputs, subject_target(process, settings.subject_input))
    unit = require_unit(received)
    with take_archive(services, workspace, received, unit, folder, volumes=volumes, reserved_bytes=reserved_bytes) as taken:
        subjects = put_together(settings, _subjects(settings, taken))
        yield read_cohort(services, workspace, settings, subjects, refused=taken.refused, subscriber=subscriber)


_ANY = MeshReference(href=mesh_path("0" * 8 + "-0000-0000-0000-" + "0" * 12))


def _subjects(settings: ArchiveSettings, taken: TakenArchive) -> list[SubjectRequest]:
    own = {one.name: one.inputs for one in settings.subjects}
    names = {name for name, _ in taken.meshes} | {one.subject for one in taken.refused}
    for name in own:
        if name not in names:
            raise InputError("cohort.subject_unknown", f"The archive has no subject called '{name}'", name=name)
    return [
        SubjectRequest(name=name, mesh=MeshReference(href=mesh_path(record.id)), inputs=own.get(name, {}))
        for name, record in taken.meshes
    ]
