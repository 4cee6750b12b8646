"""Database, broker and store: do they answer, how fast, and is what they give back what they were given."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from datetime import UTC, datetime

from sqlalchemy import text

from server.doctor.diagnosis import Diagnosis, fine, size, warning, wrong
from server.doctor.patient import Patient
from server.valkey import broker_url, choose_socket_path
from store.doorbell import Doorbell
from store.settings import Settings
from store.sqlite_file import SPARE_SHARE, SqliteFile

SKEW_S = 2.0
SLOW_MS = 200.0


def examine_backends(patient: Patient) -> Iterator[Diagnosis]:
    """A small file is put into the store and taken away again; nothing else is changed."""
    yield from _database(patient)
    yield _clock(patient)
    yield _broker(patient)
    yield _store(patient)


def _database(patient: Patient) -> Iterator[Diagnosis]:
    started = time.perf_counter()
    patient.db.ping()
    took_ms = (time.perf_counter() - started) * 1000
    said = f"revision {patient.db.revision()}, answers in {took_ms:.0f} ms"
    if not patient.db.is_migrated():
        yield wrong("database", said, "its tables are not those of this version: python -m store.migrate")
    elif took_ms > SLOW_MS:
        yield warning("database", said, "look at its load and at the network between")
    else:
        yield fine("database", said)
    if patient.db.is_sqlite:
        yield from _sqlite(patient)


def _sqlite(patient: Patient) -> Iterator[Diagnosis]:
    with patient.db.reading() as session:
        broken = [row[0] for row in session.execute(text("PRAGMA quick_check(3)")) if row[0] != "ok"]
        dangling = session.execute(text("PRAGMA foreign_key_check")).first()
    if broken or dangling:
        said = broken[0] if broken else f"a row of {dangling[0]} refers to one that is not there" if dangling else ""
        yield wrong("database file", f"damaged: {said}", "stop the server; restore a backup into an empty folder")
        return
    use = SqliteFile(patient.db).measure()
    said = f"whole; {size(use.bytes)}, of it {size(use.spare_bytes)} spare; log of {size(use.wal_bytes)}"
    if not use.gives_back and use.spare_bytes > SPARE_SHARE * use.bytes:
        yield warning("database file", said, "it cannot shrink by itself: integument admin gc --rewrite")
    else:
        yield fine("database file", said)


def _clock(patient: Patient) -> Diagnosis:
    before = datetime.now(UTC)
    with patient.db.reading() as session:
        theirs = patient.db.now(session)
    ours = before + (datetime.now(UTC) - before) / 2
    skew_s = (ours - theirs).total_seconds()
    said = f"this host is {abs(skew_s):.3f} s {'ahead of' if skew_s >= 0 else 'behind'} the database"
    if abs(skew_s) > SKEW_S:
        return warning("clock", said, "leases do not mind, but signatures and file ages do: run an NTP client on both")
    return fine("clock", said)


def _broker(patient: Patient) -> Diagnosis:
    doorbell = Doorbell(_broker_url(patient.settings), patient.settings.queue)
    try:
        if doorbell.is_answered():
            return fine("broker", "answers")
    finally:
        doorbell.close()
    return wrong("broker", "does not answer", "start Valkey, or correct INTEGUMENT_BROKER_URL; what was accepted waits meanwhile")


def _broker_url(settings: Settings) -> str:
    """Of an embedded server the private one in its folder."""
    folder = settings.data_dir / "valkey"
    is_embedded = "broker_url" not in settings.model_fields_set and folder.is_dir()
    return broker_url(choose_socket_path(folder)) if is_embedded else settings.broker_url


def _store(patient: Patient) -> Diagnosis:
    content = os.urandom(4096)
    started = time.perf_counter()
    blob = patient.blobs.put_bytes(content)
    try:
        with patient.blobs.open(blob.sha256) as file:
            back = file.read()
    finally:
        patient.blobs.delete(blob.sha256)
    took_ms = (time.perf_counter() - started) * 1000
    where = "the object store" if patient.settings.blobs_url else str(patient.settings.blob_dir)
    if back != content:
        return wrong("store", f"{where} gave back other bytes than it was given", "take it out of use; check its disks")
    return fine("store", f"{where}: a file written, read and removed in {took_ms:.0f} ms")
