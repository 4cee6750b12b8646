"""Files and rows: is every file there that a row names, is it what it is called, and what lies there for nobody."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Iterator

from core.errors import InternalError
from server.doctor.diagnosis import Diagnosis, fine, size, warning, wrong
from server.doctor.patient import Patient
from server.garbage import Garbage
from store.blobs import CHUNK_BYTES
from store.references import References

TOLD = 3  # names of files in a message
GARBAGE_BYTES = 1024**3


def examine_files(patient: Patient) -> Iterator[Diagnosis]:
    """Reads only; every byte with `deep`."""
    wanted = References(patient.db).all()
    there = {blob.sha256: blob.size for blob in patient.blobs.all()}
    wanted &= References(patient.db).all()  # removed meanwhile
    missing = sorted(wanted - there.keys())
    said = f"{len(wanted)} are named by rows, {len(there)} are there, {size(sum(there.values()))}"
    if missing:
        yield wrong(
            "files", f"{said}; {len(missing)} are missing: {_some(missing)}", "integument admin restore FOLDER --files-only"
        )
    else:
        yield fine("files", said)
    if patient.deep:
        corrupt = [name for name in sorted(wanted & there.keys()) if not _is_whole(patient, name)]
        if corrupt:
            told = f"{len(corrupt)} are not what they are called: {_some(corrupt)}"
            yield wrong("contents", told, "integument admin restore FOLDER --files-only; check the disk")
        else:
            yield fine("contents", f"every byte of {len(wanted)} files read and proven")
    yield _garbage(patient)


def _garbage(patient: Patient) -> Diagnosis:
    heaps = [
        heap
        for heap in Garbage(patient.settings, patient.db, patient.blobs).find()
        if heap.count and heap.kind != "write-ahead log"
    ]
    total = sum(heap.bytes or 0 for heap in heaps)
    said = ", ".join(f"{heap.count} {heap.kind}" for heap in heaps) or "none"
    if total > GARBAGE_BYTES:
        return warning("garbage", f"{said}: {size(total)}", "the next sweep takes it; if not: integument admin gc")
    return fine("garbage", f"{said}: {size(total)}")


def _is_whole(patient: Patient, sha256: str) -> bool:
    digest = hashlib.sha256()
    try:
        with patient.blobs.open(sha256) as file:
            while chunk := file.read(CHUNK_BYTES):
                digest.update(chunk)
    except InternalError as error:
        if error.code == "blob.missing":  # removed meanwhile
            return True
        raise
    return digest.hexdigest() == sha256


def _some(names: Collection[str]) -> str:
    told = ", ".join(list(names)[:TOLD])
    return f"{told}, ..." if len(names) > TOLD else told
