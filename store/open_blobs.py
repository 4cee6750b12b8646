"""The blobs that the settings name."""

from __future__ import annotations

from store.blobs import Blobs
from store.database import Database
from store.local_blobs import LocalBlobs
from store.s3_place import S3Place
from store.settings import Settings
from store.sweep_lock import DatabaseLock, FileLock


def open_blobs(settings: Settings, db: Database) -> Blobs:
    """Connects to nothing yet."""
    if not settings.blobs_url:
        return LocalBlobs(settings.blob_dir)
    from store.s3_blobs import S3Blobs  # its libraries take half a second to load, which a folder need not wait for

    settings.data_dir.mkdir(parents=True, exist_ok=True, mode=0o700)
    lock = FileLock(settings.data_dir / "blobs.lock") if db.is_sqlite else DatabaseLock(db)
    return S3Blobs(S3Place.of(settings.blobs_url), lock, settings.blobs_links_s)
