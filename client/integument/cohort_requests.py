"""What the client can ask about cohorts; a part of `Client`."""

from __future__ import annotations

import json
import os
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from uuid import uuid4

from integument.answer import read_json
from integument.begun_upload import BegunUpload, Memory
from integument.cohort import Cohort
from integument.download import download
from integument.errors import ArgumentError, ProblemError
from integument.job import Job
from integument.result import Results
from integument.surface_processes import MeshInput, Unit
from integument.transport import Transport
from integument.upload import CountedFile, OnBytes, Source, opened

LOOK_S = 1.0
ARCHIVE_TIMEOUT_S = 3600.0  # every mesh of it is read before the answer comes
NOT_FOUND = "upload.not_found"
OVER = (NOT_FOUND, "upload.spent", "idempotency.mismatch")  # nothing comes of an upload begun earlier: send it anew
OnCohort = Callable[[Cohort], None]


class CohortRequests(ABC):
    """Cohorts: one process on many subjects, each a job of its own, and one summary."""

    _transport: Transport

    @abstractmethod
    def _reference(self, mesh: MeshInput, unit: Unit) -> dict[str, str]: ...

    @abstractmethod
    def _get(self, path: str, params: Mapping[str, Any] | None = None) -> Any: ...

    @abstractmethod
    def _pages(self, path: str, key: str, params: Mapping[str, Any], limit: int | None) -> Iterator[Any]: ...

    def create_cohort(
        self,
        process: str,
        subjects: Mapping[str, MeshInput] | Sequence[MeshInput],
        inputs: Mapping[str, Any] | None = None,
        *,
        overrides: Mapping[str, Mapping[str, Any]] | None = None,
        subject_input: str | None = None,
        unit: Unit = "mm",
        name: str | None = None,
        labels: Sequence[str] = (),
        idempotency_key: str | None = None,
    ) -> Cohort:
        """Queue a job for every subject, or none; uploads what the server does not hold. Subjects may have names; `overrides`:
        name of a subject -> inputs of its own.

        Raises: ArgumentError (inputs that are no JSON, an override of nobody), ProblemError.
        """
        named = subjects if isinstance(subjects, Mapping) else {}
        if strange := set(overrides or ()) - set(named):
            raise ArgumentError(f"there is no subject called {', '.join(sorted(strange))}")
        listed: list[dict[str, Any]] = []
        if isinstance(subjects, Mapping):
            for subject, mesh in subjects.items():
                told = {"name": subject, "mesh": self._reference(mesh, unit)}
                listed.append({**told, "inputs": dict((overrides or {}).get(subject, {}))})
        else:
            listed += [{"mesh": self._reference(mesh, unit)} for mesh in subjects]
        body = _settings(process, inputs, subject_input, name, labels) | {"subjects": listed}
        headers = {"Content-Type": "application/json", "Idempotency-Key": idempotency_key or str(uuid4())}
        response = self._transport.request("POST", "/v1/cohorts", content=_to_json(body), headers=headers)
        return Cohort.read(read_json(response), "the new cohort")

    def create_cohort_of_archive(
        self,
        process: str,
        archive: Source,
        inputs: Mapping[str, Any] | None = None,
        *,
        overrides: Mapping[str, Mapping[str, Any]] | None = None,
        subject_input: str | None = None,
        unit: Unit = "mm",
        name: str | None = None,
        labels: Sequence[str] = (),
        on_bytes: OnBytes | None = None,
    ) -> Cohort:
        """The same with a zip of mesh files; those that cannot be read are refused alone.

        It is sent in pieces. A call for the file of an earlier one that did not come to its end goes on where that one stopped.
        Raises: ArgumentError, ProblemError (the zip cannot be read: codes `archive.*`).
        """
        own = [{"name": subject, "inputs": dict(override)} for subject, override in (overrides or {}).items()]
        body = _to_json(_settings(process, inputs, subject_input, name, labels) | {"subjects": own})
        memory = Memory.of(archive, unit)
        with opened(archive, on_bytes) as (file, file_name):
            if (begun := memory.recall()) is not None:
                try:
                    return self._finish_archive(begun, file, body, memory)
                except ProblemError as error:
                    if error.code not in OVER:
                        raise
            begun = BegunUpload.begin(self._transport, file, file_name, unit)
            memory.keep(begun)
            return self._finish_archive(begun, file, body, memory)

    def _finish_archive(self, begun: BegunUpload, file: CountedFile, body: str, memory: Memory) -> Cohort:
        """Send what the server does not have, and make the cohort. An upload that is gone may be a cohort: its key tells."""
        try:
            begun.send_rest(self._transport, file)
        except ProblemError as error:
            if error.code != NOT_FOUND:
                raise
        headers = {"Content-Type": "application/json", "Idempotency-Key": begun.key}
        path = f"{begun.path}/cohort"
        response = self._transport.request("POST", path, content=body, headers=headers, read_timeout_s=ARCHIVE_TIMEOUT_S)
        memory.forget()
        return Cohort.read(read_json(response), "the new cohort")

    def cohort(self, cohort_id: str) -> Cohort:
        """How the cohort stands."""
        return Cohort.read(self._get(f"/v1/cohorts/{cohort_id}"), "the cohort")

    def cohorts(self, *, limit: int | None = None) -> Iterator[Cohort]:
        """The newest first; further pages are fetched as needed."""
        return (Cohort.read(item, "a cohort of the list") for item in self._pages("/v1/cohorts", "cohorts", {}, limit))

    def cohort_jobs(self, cohort: Cohort | str) -> list[Job]:
        """The jobs of all subjects, in the order of the request."""
        found = self._pages("/v1/jobs", "jobs", {"cohort": _id(cohort), "limit": "1000"}, None)
        return [Job.read(item, "a job of the cohort") for item in found][::-1]

    def wait_for_cohort(self, cohort: Cohort | str, on_cohort: OnCohort | None = None, *, look_s: float = LOOK_S) -> Cohort:
        """Wait until all subjects and the summary have ended, however they did."""
        while True:
            now = self.cohort(_id(cohort))
            if on_cohort is not None:
                on_cohort(now)
            if now.done:
                return now
            time.sleep(look_s)

    def dismiss_cohort(self, cohort: Cohort | str) -> Cohort:
        """Cancel what waits or runs; a cohort of which nothing does is removed with all it made."""
        response = self._transport.request("DELETE", f"/v1/cohorts/{_id(cohort)}", repeatable=False)
        return Cohort.read(read_json(response), "the dismissed cohort")

    def retry_cohort(self, cohort: Cohort | str) -> Cohort:
        """Queue its failed and dismissed jobs once more."""
        headers = {"Idempotency-Key": str(uuid4())}
        response = self._transport.request("POST", f"/v1/cohorts/{_id(cohort)}/retry", headers=headers)
        return Cohort.read(read_json(response), "the retried cohort")

    def cohort_results(self, cohort: Cohort | str) -> Results:
        """The summary as `table` (CSV), `summary` (JSON) and `report_html`, and `packages`."""
        return Results.read(self._get(f"/v1/cohorts/{_id(cohort)}/results"))

    def download_packages(self, cohort: Cohort | str, path: str | os.PathLike[str]) -> Path:
        """What all jobs made as one zip with a folder per subject. It is made while it comes, so a broken call begins anew."""
        target = Path(path)
        part = target.with_name(f"{target.name}.part")
        source = f"/v1/cohorts/{_id(cohort)}/results/packages"
        headers = {"Accept-Encoding": "identity"}
        with self._transport.stream("GET", source, headers=headers) as response, part.open("wb") as file:
            for piece in response.iter_bytes():
                file.write(piece)
        part.replace(target)
        return target

    def download_summary(self, cohort: Cohort | str, output: str, path: str | os.PathLike[str]) -> Path:
        """One of `table`, `summary` and `report_html` into a file, checked against the server's SHA-256."""
        found = self.cohort(_id(cohort))
        return download(self._transport, f"/v1/jobs/{found.summary_job}/results/{output}", Path(path), None)


def _settings(
    process: str, inputs: Mapping[str, Any] | None, subject_input: str | None, name: str | None, labels: Sequence[str]
) -> dict[str, Any]:
    told = {"process": process, "inputs": dict(inputs or {}), "labels": list(labels)}
    return told | ({"subjectInput": subject_input} if subject_input else {}) | ({"name": name} if name else {})


def _to_json(body: Mapping[str, Any]) -> str:
    try:
        return json.dumps(body, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"the inputs are no JSON: {error}") from error


def _id(cohort: Cohort | str) -> str:
    return cohort.id if isinstance(cohort, Cohort) else cohort
