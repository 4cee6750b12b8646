"""All looks, one after the other; one that breaks off is a finding itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from core.errors import IntegumentError
from server.doctor.backends import examine_backends
from server.doctor.diagnosis import Diagnosis, wrong
from server.doctor.files import examine_files
from server.doctor.host import examine_host
from server.doctor.patient import Patient
from server.doctor.work import examine_work

LOOKS: dict[str, Callable[[Patient], Iterator[Diagnosis]]] = {
    "host": examine_host,
    "backends": examine_backends,
    "work": examine_work,
    "files": examine_files,
}


def examine(patient: Patient) -> list[Diagnosis]:
    """Everything."""
    found: list[Diagnosis] = []
    for part, look in LOOKS.items():
        try:
            found.extend(look(patient))
        except (IntegumentError, OSError) as error:
            code = error.code if isinstance(error, IntegumentError) else type(error).__name__
            found.append(wrong(part, f"cannot be looked at: {error} [{code}]", "docs/errors.md says what the code means"))
    return found
