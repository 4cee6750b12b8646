"""Where the bytes of an upload in pieces are put: a file of this host, or the blobs, where every API host finds them."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Protocol

from api.partial_file import PartialFile
from api.services import Services
from core.errors import StateError
from store.uploads import Upload
from store.workspace import WorkspaceId

KEPT_BYTES = 64 * 1024 * 1024  # at most that much is sent again after a crash
PART_BYTES = 32 * 1024 * 1024  # the same where each part is an object of its own


class UploadTarget(Protocol):
    """Of one request, with the upload's file of this host locked. `received`: bytes that are here, kept or not.

    keeps_beside: `append` may go on in another thread while `keep` is at work."""

    kept_every_bytes: int
    keeps_beside: bool
    received: int

    def begin(self) -> None:
        """Forget what was written behind the bytes that count. Raises StateError `upload.elsewhere`."""
        ...

    def append(self, piece: bytes) -> None:
        """Raises LimitError `storage.full`."""
        ...

    def keep(self) -> Upload:
        """After this the bytes survive everything. Raises StateError `upload.not_found`, `upload.offset_differs`."""
        ...

    def whole(self, folder: Path) -> tuple[Path, str]:
        """All bytes of a finished upload as a file, and its SHA-256; `folder` is scratch space.

        Raises StateError `upload.elsewhere`, InternalError `blob.missing`."""
        ...


class HostFile:
    """One growing file in the data folder; its bytes are on the disk before they are acknowledged."""

    kept_every_bytes = KEPT_BYTES
    keeps_beside = True  # or the network would wait for the disk, and then the disk for the network

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

    def append(self, piece: bytes) -> None:
        """As `UploadTarget` says."""
        self._file.append(piece)
        self.received = self._file.size

    def keep(self) -> Upload:
        """As `UploadTarget` says."""
        size = self._file.size  # what comes meanwhile counts the next time
        self._file.sync()
        return self._uploads.advance(self._workspace, self._upload.id, size)

    def whole(self, folder: Path) -> tuple[Path, str]:
        """As `UploadTarget` says."""
        del folder
        self.begin()
        with self._file.path.open("rb") as file:
            return self._file.path, hashlib.file_digest(file, "sha256").hexdigest()


class StoredParts:
    """Each stretch of bytes becomes a blob before it is acknowledged, so the next request may go to any host."""

    kept_every_bytes = PART_BYTES
    keeps_beside = False

    def __init__(self, services: Services, workspace: WorkspaceId, upload: Upload, file: PartialFile) -> None:
        self._uploads = services.uploads
        self._blobs = services.blobs
        self._workspace = workspace
        self._upload = upload
        self._file = file
        self.received = upload.received

    def begin(self) -> None:
        """As `UploadTarget` says."""
        self._file.cut(0)

    def append(self, piece: bytes) -> None:
        """As `UploadTarget` says."""
        self._file.append(piece)
        self.received += len(piece)

    def keep(self) -> Upload:
        """As `UploadTarget` says."""
        if self._file.size:
            part = self._blobs.put_file(self._file.path)
            self._upload = self._uploads.add_part(self._workspace, self._upload.id, self._upload.received, part)
            self._file.cut(0)
        return self._upload

    def whole(self, folder: Path) -> tuple[Path, str]:
        """As `UploadTarget` says."""
        path, digest = folder / "whole", hashlib.sha256()
        with path.open("xb") as file:
            for part in self._uploads.parts(self._workspace, self._upload.id):
                for chunk in self._blobs.read(part.sha256, 0, part.size):
                    digest.update(chunk)
                    file.write(chunk)
        return path, digest.hexdigest()


def upload_target(services: Services, workspace: WorkspaceId, upload: Upload, file: PartialFile) -> UploadTarget:
    """Parts where the blobs are an object store, else a file."""
    kind = StoredParts if services.settings.blobs_url else HostFile
    return kind(services, workspace, upload, file)
