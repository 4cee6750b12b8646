"""From the body of a request for a cohort to what the table takes: every subject validated and found, or all refused."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError
from sqlalchemy.orm import Session

from api.cohort_documents import cohort_path
from api.execution import resolve_meshes
from api.idempotency import Once
from api.process_documents import find_process
from api.schemas.cohort import CohortSettings, SubjectRequest
from api.services import Services
from api.sizing import size_up
from api.violations import ViolationsError
from core.errors import InputError, IntegumentError, LimitError
from core.schema.cohort import SUBJECT_INPUTS, subject_input_of
from core.schema.model import FrozenModel
from core.schema.processes import ProcessDescription
from store.callback import Subscriber
from store.cohort import Cohort, RefusedSubject
from store.cohorts import NewCohort, NewSubject
from store.idempotency import Reply
from store.job_words import JobWords
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class Wanted:
    """One subject, its inputs put together but not yet looked at. `place`: its number in the request."""

    place: int
    name: str | None
    inputs: Mapping[str, Any]


def require_few(services: Services, count: int) -> None:
    """Raises LimitError `cohort.too_many_subjects`."""
    limit = services.settings.cohort_subjects
    if count > limit:
        raise LimitError(
            "cohort.too_many_subjects", f"{count} subjects were sent, a cohort may have {limit}", subjects=count, limit=limit
        )


def put_together(settings: CohortSettings, subjects: Sequence[SubjectRequest]) -> list[Wanted]:
    """Raises StateError `process.not_found`, InputError `cohort.no_mesh_input`."""
    process = find_process(settings.process)
    target = subject_target(process, settings.subject_input) if any(one.mesh is not None for one in subjects) else None
    return [
        Wanted(
            place,
            one.name,
            {**settings.inputs, **one.inputs}
            | ({} if one.mesh is None or target is None else {target: one.mesh.model_dump(exclude_none=True)}),
        )
        for place, one in enumerate(subjects)
    ]


def read_cohort(
    services: Services,
    workspace: WorkspaceId,
    settings: CohortSettings,
    wanted: Iterable[Wanted],
    *,
    refused: Sequence[RefusedSubject] = (),
    subscriber: Subscriber | None = None,
) -> NewCohort:
    """Raises ViolationsError `inputs.*`, InputError `reference.*`, `cohort.subject_twice`, LimitError `job.too_large_for_memory`,
    with the subject in the message."""
    process = find_process(settings.process)
    subjects: list[NewSubject] = []
    names = {one.subject.casefold() for one in refused}
    for one in wanted:
        subject = _read(services, workspace, process, one)
        if subject.name.casefold() in names:
            raise InputError(
                "cohort.subject_twice",
                f"two subjects are called '{subject.name}'; give them names of their own",
                name=subject.name,
            )
        names.add(subject.name.casefold())
        subjects.append(subject)
    return NewCohort(process.id, settings.inputs, subjects, refused, JobWords(settings.name, settings.labels), subscriber)


def accept_cohort(
    services: Services, workspace: WorkspaceId, new: NewCohort, once: Once, also: Callable[[Session], None] = lambda session: None
) -> Cohort:
    """Into the table, with the reply that is kept and what `also` does there; then ring for all its jobs.

    Raises as `Cohorts.create`."""
    attempts = services.settings.max_attempts + find_process(new.process).more_attempts
    with services.db.session() as session:
        cohort, jobs = services.cohorts.create(workspace, new, max_attempts=attempts, session=session)
        once.keep(Reply(201, {"Location": cohort_path(cohort.id)}, {"cohort": cohort.id}), session)
        also(session)
    services.ringer.ring_cohort(cohort.id, jobs)
    return cohort


def find_cohort(services: Services, workspace: WorkspaceId, kept: Mapping[str, Any]) -> Cohort:
    """That an earlier request with the same key made. Raises StateError `cohort.not_found`."""
    return services.cohorts.get(workspace, str(kept["cohort"]))


def subject_target(process: ProcessDescription, named: str | None) -> str:
    """The input that takes the mesh of a subject. Raises InputError `cohort.no_mesh_input`."""
    if named is not None and named not in process.inputs.model_fields:
        raise InputError("cohort.no_mesh_input", f"Process '{process.id}' has no input '{named}'; subjectInput names one it has")
    target = named or subject_input_of(process.inputs)
    if target is None:
        raise InputError(
            "cohort.no_mesh_input",
            f"Process '{process.id}' has none of the inputs {', '.join(SUBJECT_INPUTS)}; name one as subjectInput, or give every "
            "subject inputs instead of a mesh",
        )
    return target


def _read(services: Services, workspace: WorkspaceId, process: ProcessDescription, wanted: Wanted) -> NewSubject:
    said = wanted.name or f"number {wanted.place + 1}"
    try:
        inputs = validated(process, wanted)
        stored, meshes = resolve_meshes(services, workspace, inputs)
        expectation = size_up(services, process.id, stored, meshes)
    except ViolationsError as error:
        error.message = f"subject {said}: {error.message}"
        raise
    except IntegumentError as error:
        refused = type(error)(error.code, f"subject {said}: {error.message}")
        refused.facts = error.facts
        raise refused from error
    name = wanted.name or (meshes[0].name if meshes else f"subject {wanted.place + 1}")
    return NewSubject(name, stored, tuple(meshes), expectation)


def validated(process: ProcessDescription, wanted: Wanted) -> FrozenModel:
    """The inputs of one subject. Raises ViolationsError `inputs.invalid`, `inputs.unknown_key`."""
    try:
        return process.inputs.model_validate(dict(wanted.inputs))
    except ValidationError as error:
        base = f"/subjects/{wanted.place}/inputs"
        raise ViolationsError("inputs.invalid", "inputs.unknown_key", error, base=base, sent=wanted.inputs) from None
