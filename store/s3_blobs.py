"""Blobs in an S3-compatible object store, for hosts that share no disk."""

from __future__ import annotations

import errno
import hashlib
from collections.abc import Container, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TypeVar, cast
from uuid import uuid4

import boto3
from boto3.exceptions import Boto3Error
from boto3.s3.transfer import TransferConfig
from botocore.config import Config
from botocore.exceptions import BotoCoreError, ClientError

from core.errors import InternalError, LimitError
from store.blobs import CHUNK_BYTES, Blob, is_corrupt, is_missing, require_digest
from store.regular_file import open_regular_file
from store.s3_place import S3Place
from store.sweep_lock import SweepLock

if TYPE_CHECKING:
    from types_boto3_s3.client import S3Client

T = TypeVar("T")

PART_BYTES = 64 * 1024 * 1024
CONNECT_S, READ_S, ATTEMPTS = 5, 60, 4
SWEEP_BATCH = 50
PARTS_S = 86_400.0  # a file that takes longer to be sent has no sender any more
TOUCHED = "touched/"
DIGEST_LETTERS = 64
MISSING_CODES = frozenset({"404", "NoSuchKey", "NotFound"})
FULL_CODES = frozenset({"507", "InsufficientStorage", "QuotaExceeded", "XMinioStorageFull"})


class S3Blobs:
    """Keys: `ab/cd/abcd…`, and `touched/abcd…`, an empty object that makes a blob young without copying it.

    An object appears whole or not at all, so a crash at any step leaves the old state or the new one. Thread-safe."""

    def __init__(self, place: S3Place, lock: SweepLock, links_s: float = 0.0) -> None:
        self._place = place
        self._lock = lock
        self._links_s = int(links_s)
        self._client = _connect(place)
        self._transfer = TransferConfig(multipart_threshold=PART_BYTES, multipart_chunksize=PART_BYTES, max_concurrency=2)

    def put_file(self, path: Path) -> Blob:
        """As `Blobs` says."""
        with open_regular_file(path) as file:
            return self.put_open(file)

    def put_open(self, file: BinaryIO) -> Blob:
        """As `Blobs` says; a large file goes in parts."""
        file.seek(0)
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()  # type: ignore[arg-type]  # any that is read into a buffer
        blob = Blob(sha256, file.tell())
        if not self._has(blob):
            file.seek(0)
            with _translated(sha256):
                self._client.upload_fileobj(file, self._place.bucket, self._key(sha256), Config=self._transfer)
        return blob

    def put_bytes(self, data: bytes) -> Blob:
        """As `Blobs` says."""
        sha256 = hashlib.sha256(data).hexdigest()
        blob = Blob(sha256, len(data))
        if not self._has(blob):
            with _translated(sha256):
                self._client.put_object(Bucket=self._place.bucket, Key=self._key(sha256), Body=data)
        return blob

    def _has(self, blob: Blob) -> bool:
        """True if it is there; then it is made young, as by `touch`."""
        return self._size(blob.sha256) == blob.size and self.touch(blob.sha256)

    def _size(self, sha256: str) -> int | None:
        try:
            with _translated(sha256):
                return self._client.head_object(Bucket=self._place.bucket, Key=self._key(sha256))["ContentLength"]
        except InternalError as error:
            if error.code == "blob.missing":
                return None
            raise

    def open(self, sha256: str) -> BinaryIO:
        """As `Blobs` says."""
        with _translated(sha256):
            body = self._client.get_object(Bucket=self._place.bucket, Key=self._key(sha256))["Body"]
        return cast("BinaryIO", body)

    def read(self, sha256: str, start: int, stop: int) -> Iterator[bytes]:
        """As `Blobs` says."""
        if start >= stop:
            return
        with _translated(sha256):
            span = f"bytes={start}-{stop - 1}"
            body = self._client.get_object(Bucket=self._place.bucket, Key=self._key(sha256), Range=span)["Body"]
            with body:
                yield from body.iter_chunks(CHUNK_BYTES)

    def fetch(self, sha256: str, folder: Path) -> Path:
        """A copy in the folder."""
        path = folder / require_digest(sha256)
        digest = hashlib.sha256()
        try:
            with self.open(sha256) as body, path.open("wb") as file, _translated(sha256):
                while chunk := body.read(CHUNK_BYTES):
                    digest.update(chunk)
                    file.write(chunk)
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EDQUOT):
                raise LimitError("storage.full", "the disk is full, a mesh cannot be fetched") from error
            raise
        if digest.hexdigest() != sha256:
            path.unlink()
            raise is_corrupt(sha256)
        return path

    def link(self, sha256: str, disposition: str, media_type: str) -> str | None:
        """A presigned URL, if they are switched on."""
        if not self._links_s:
            return None
        asked = {
            "Bucket": self._place.bucket,
            "Key": self._key(sha256),
            "ResponseContentDisposition": disposition,
            "ResponseContentType": media_type,
        }
        return self._client.generate_presigned_url("get_object", Params=asked, ExpiresIn=self._links_s)

    def touch(self, sha256: str) -> bool:
        """As `Blobs` says."""
        with self._lock.held(), _translated(sha256):
            if self._size(sha256) is None:
                return False
            self._client.put_object(Bucket=self._place.bucket, Key=self._touched_key(sha256), Body=b"")
        return True

    def delete(self, sha256: str) -> bool:
        """As `Blobs` says."""
        if self._size(sha256) is None:
            return False
        with _translated(sha256):
            for key in (self._key(sha256), self._touched_key(sha256)):
                self._client.delete_object(Bucket=self._place.bucket, Key=key)
        return True

    def all(self) -> Iterator[Blob]:
        """As `Blobs` says."""
        for blob, _changed in self._listed():
            yield blob

    def orphans(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """As `Blobs` says; those touched lately are still among them."""
        before = self._now() - timedelta(seconds=older_than_s)
        return [blob for blob, changed in self._listed() if blob.sha256 not in referenced and changed < before]

    def sweep(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """As `Blobs` says; writers wait for a few deletions at a time."""
        before = self._now() - timedelta(seconds=older_than_s)
        unwanted = self.orphans(referenced, older_than_s)
        swept = []
        for some in _batches(unwanted, SWEEP_BATCH):
            with self._lock.held(alone=True):
                swept += [blob for blob in some if self._is_old(blob, before) and self.delete(blob.sha256)]
        self._forget_touches(before)
        self._abort_parts(min(before, datetime.now(UTC) - timedelta(seconds=PARTS_S)))
        return swept

    def _abort_parts(self, before: datetime) -> None:
        """Uploads in parts whose writer was killed: nobody sees them, yet they are kept, and paid for."""
        with _translated(""):
            pages = self._client.get_paginator("list_multipart_uploads").paginate(
                Bucket=self._place.bucket, Prefix=self._place.prefix
            )
            for page in pages:
                for upload in page.get("Uploads", ()):
                    if upload["Initiated"] < before:
                        self._client.abort_multipart_upload(
                            Bucket=self._place.bucket, Key=upload["Key"], UploadId=upload["UploadId"]
                        )

    def _is_old(self, blob: Blob, before: datetime) -> bool:
        """Asked again under the lock: somebody may have wanted it meanwhile."""
        return all(self._changed(key, blob.sha256) < before for key in (self._key(blob.sha256), self._touched_key(blob.sha256)))

    def _changed(self, key: str, sha256: str) -> datetime:
        try:
            with _translated(sha256):
                return self._client.head_object(Bucket=self._place.bucket, Key=key)["LastModified"]
        except InternalError as error:
            if error.code == "blob.missing":
                return datetime.min.replace(tzinfo=UTC)
            raise

    def _forget_touches(self, before: datetime) -> None:
        prefix = self._place.prefix + TOUCHED
        with _translated(""):
            for page in self._pages(prefix):
                old = [(key, sha256) for key, sha256, _size, changed in page if changed < before]
                for some in _batches(old, SWEEP_BATCH):
                    with self._lock.held(alone=True):
                        for key, sha256 in some:
                            if self._changed(key, sha256) < before:
                                self._client.delete_object(Bucket=self._place.bucket, Key=key)

    def _listed(self) -> Iterator[tuple[Blob, datetime]]:
        with _translated(""):
            for page in self._pages(self._place.prefix):
                for key, sha256, size, changed in page:
                    if key == self._key(sha256):
                        yield Blob(sha256, size), changed

    def _pages(self, prefix: str) -> Iterator[list[tuple[str, str, int, datetime]]]:
        """Key, its last part, size and moment of the last change, for all objects that are named after a blob."""
        pages = self._client.get_paginator("list_objects_v2").paginate(Bucket=self._place.bucket, Prefix=prefix)
        for page in pages:
            rows = [
                (row["Key"], row["Key"].rpartition("/")[2], row["Size"], row["LastModified"]) for row in page.get("Contents", ())
            ]
            yield [row for row in rows if len(row[1]) == hashlib.sha256().digest_size * 2]

    def _now(self) -> datetime:
        """By the clock that stamps the objects, to the next second: that of this process may be off."""
        with _translated(""):
            bucket, key = self._place.bucket, f"{self._place.prefix}clock/{uuid4()}"
            self._client.put_object(Bucket=bucket, Key=key, Body=b"")
            moment = self._client.head_object(Bucket=bucket, Key=key)["LastModified"]
            self._client.delete_object(Bucket=bucket, Key=key)
        return moment + timedelta(seconds=1)

    def check(self) -> None:
        """As `Blobs` says: an object is written and taken away again."""
        with _translated(""):
            key = f"{self._place.prefix}probe"
            self._client.put_object(Bucket=self._place.bucket, Key=key, Body=b"ready")
            self._client.delete_object(Bucket=self._place.bucket, Key=key)

    def _key(self, sha256: str) -> str:
        require_digest(sha256)
        return f"{self._place.prefix}{sha256[:2]}/{sha256[2:4]}/{sha256}"

    def _touched_key(self, sha256: str) -> str:
        return f"{self._place.prefix}{TOUCHED}{require_digest(sha256)}"


def _batches(items: list[T], size: int) -> Iterator[list[T]]:
    for start in range(0, len(items), size):
        yield items[start : start + size]


def _connect(place: S3Place) -> S3Client:
    return boto3.client(
        "s3",
        endpoint_url=place.endpoint,
        region_name=place.region,
        aws_access_key_id=place.key,
        aws_secret_access_key=place.secret,
        config=Config(
            signature_version="s3v4",
            connect_timeout=CONNECT_S,
            read_timeout=READ_S,
            retries={"mode": "standard", "total_max_attempts": ATTEMPTS},
            s3={"addressing_style": "path" if place.endpoint else "auto"},
            request_checksum_calculation="when_required",  # other makers' stores do not know the newer checksums
            response_checksum_validation="when_required",
        ),
    )


@contextmanager
def _translated(sha256: str) -> Iterator[None]:
    """The store's words become ours."""
    try:
        yield
    except ClientError as error:
        code = str(error.response.get("Error", {}).get("Code", ""))
        if code in MISSING_CODES:
            raise is_missing(sha256) from error
        if code in FULL_CODES:
            raise LimitError("storage.full", f"the object store is full: {code}") from error
        raise InternalError("blobs.unavailable", f"the object store refuses: {code}") from error
    except (BotoCoreError, Boto3Error) as error:
        raise InternalError("blobs.unavailable", f"the object store does not answer: {type(error).__name__}") from error
