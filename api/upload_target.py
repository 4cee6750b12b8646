"""Where the bytes of an upload in pieces are put: a file of this host, or the blobs, where every API host finds them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO, Protocol, cast

from api.partial_file import PartialFile, write_at
from api.services import Services
from core.errors import StateError
from store.blobs import is_corrupt
from store.uploads import Upload
from store.workspace import WorkspaceId

KEPT_BYTES = 64 * 1024 * 1024  # at most twice that much is sent again after a crash
PART_BYTES = 32 * 1024 * 1024  # the same where each part is an object of its own


class UploadTarget(Protocol):
    """Of one request, with the upload's file of this host locked. `received`: bytes that are here, kept or not."""

    kept_every_bytes: int
    received: int

    def begin(self) -> None:
        """Forget what was written behind the bytes that count. Raises StateError `upload.elsewhere`."""
        ...

    def append(self, chunks: Sequence[bytes]) -> None:
        """Raises LimitError `storage.full`."""
        ...

    def seal(self) -> Callable[[], Upload]:
        """What came until now is a stretch of its own, and survives everything once the function returned was called.

        That may be in another thread while `append` goes on, or the network would wait for the disk, and then the disk for the
        network; but stretch after stretch. It raises StateError `upload.not_found`, `upload.offset_differs`."""
        ...

    def close(self) -> None:
        """Let go of what was not kept."""
        ...

    def whole(self, folder: Path) -> tuple[Path, str]:
        """All bytes of a finished upload as a file, and its SHA-256; `folder` is scratch space.

        Raises StateError `upload.elsewhere`, InternalError `blob.missing`, `blob.corrupt`."""
        ...


class HostFile:
    """One growing file in the data folder; its bytes are on the disk before they are acknowledged."""

    kept_every_bytes = KEPT_BYTES

    def __init__(self, services: Services, workspace: WorkspaceId, upload: Upload, file: PartialFile) -> None:
        self._uploads = services.uploads
        self._workspace = workspace
        self._upload = upload
        self._file = file
        self.received = upload.received

    def begin(self) -> None:
        """As `UploadTarget` says."""
        if self._file.present < self._upload.received:
            raise StateError(
                "upload.elsewhere",
                "the bytes of this upload are on another host of this server, or its disk was lost; send all requests of one "
                "upload to one host, or let the operator set INTEGUMENT_BLOBS_URL",
                upload=self._upload.id,
            )
        self._file.cut(self._upload.received)

    def append(self, chunks: Sequence[bytes]) -> None:
        """As `UploadTarget` says."""
        self._file.append(chunks)
        self.received = self._file.size

    def seal(self) -> Callable[[], Upload]:
        """As `UploadTarget` says."""
        return partial(self._keep, self._file.size)

    def _keep(self, size: int) -> Upload:
        self._file.sync()
        return self._uploads.advance(self._workspace, self._upload.id, size)

    def close(self) -> None:
        """Its file stays: the next request goes on with it."""

    def whole(self, folder: Path) -> tuple[Path, str]:
        """As `UploadTarget` says."""
        del folder
        self.begin()
        with self._file.path.open("rb") as file:
            return self._file.path, hashlib.file_digest(file, "sha256").hexdigest()


class StoredParts:
    """Each stretch of bytes becomes a blob before it is acknowledged, so the next request may go to any host.

    Until then it is in a file without a name, which a crash takes along, and which is rarely old enough to reach the disk."""

    kept_every_bytes = PART_BYTES

    def __init__(self, services: Services, workspace: WorkspaceId, upload: Upload) -> None:
        self._uploads = services.uploads
        self._blobs = services.blobs
        self._folder = services.uploads_dir
        self._workspace = workspace
        self._upload = upload
        self._spool: BinaryIO | None = None
        self._begins_at = upload.received
        self.received = upload.received

    def begin(self) -> None:
        """Nothing is left of other requests."""

    def append(self, chunks: Sequence[bytes]) -> None:
        """As `UploadTarget` says."""
        if self._spool is None:
            self._spool = cast("BinaryIO", TemporaryFile(dir=self._folder, buffering=0))  # noqa: SIM115 - `_keep` or `close`
        self.received = self._begins_at + write_at(self._spool.fileno(), chunks, self.received - self._begins_at)

    def seal(self) -> Callable[[], Upload]:
        """As `UploadTarget` says."""
        spool, begins_at = self._spool, self._begins_at
        self._spool, self._begins_at = None, self.received
        return lambda: self._upload if spool is None else self._keep(spool, begins_at)

    def _keep(self, spool: BinaryIO, begins_at: int) -> Upload:
        with spool:
            part = self._blobs.put_open(spool)
        self._upload = self._uploads.add_part(self._workspace, self._upload.id, begins_at, part)
        return self._upload

    def close(self) -> None:
        """As `UploadTarget` says."""
        if self._spool is not None:
            self._spool.close()

    def whole(self, folder: Path) -> tuple[Path, str]:
        """As `UploadTarget` says."""
        path, digest = folder / "whole", hashlib.sha256()
        with path.open("xb") as file:
            for part in self._uploads.parts(self._workspace, self._upload.id):
                of_part = hashlib.sha256()
                for chunk in self._blobs.read(part.sha256, 0, part.size):
                    of_part.update(chunk)
                    digest.update(chunk)
                    file.write(chunk)
                if of_part.hexdigest() != part.sha256:
                    raise is_corrupt(part.sha256)
        return path, digest.hexdigest()


def upload_target(services: Services, workspace: WorkspaceId, upload: Upload, file: PartialFile) -> UploadTarget:
    """Parts where the blobs are an object store, else a file."""
    if services.settings.blobs_url:
        return StoredParts(services, workspace, upload)
    return HostFile(services, workspace, upload, file)
