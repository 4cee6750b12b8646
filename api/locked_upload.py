"""An upload in pieces that one request turns into something: nobody else writes to it meanwhile."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from api.partial_file import PartialFile, partial_file
from api.request_folder import request_folder
from api.services import Services
from api.upload_form import ReceivedFile
from api.upload_target import upload_target
from core.errors import StateError
from store.uploads import Upload
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class LockedUpload:
    """`upload` as it stands under the lock. folder: scratch space of the request."""

    services: Services
    workspace: WorkspaceId
    upload: Upload
    file: PartialFile
    folder: Path

    def read(self, more_fields: Mapping[str, str]) -> ReceivedFile:
        """All its bytes, with the fields it was announced with and those that overrule them.

        Raises StateError `upload.incomplete`, `upload.spent`, and what `UploadTarget.whole` raises."""
        upload = self.upload
        if upload.mesh_id is not None:
            raise StateError(
                "upload.spent", f"mesh {upload.mesh_id} was made of this upload, its bytes are gone", mesh=upload.mesh_id
            )
        if upload.received < upload.length:
            raise StateError(
                "upload.incomplete",
                f"{upload.received} of {upload.length} bytes are here",
                received=upload.received,
                length=upload.length,
            )
        path, sha256 = upload_target(self.services, self.workspace, upload, self.file).whole(self.folder)
        return ReceivedFile(path, upload.file_name, upload.length, sha256, {**upload.fields, **more_fields})

    def forget(self) -> None:
        """Its bytes on this host; what was made of it has them."""
        self.file.path.unlink(missing_ok=True)


@contextmanager
def locked_upload(services: Services, workspace: WorkspaceId, upload_id: str) -> Iterator[LockedUpload]:
    """Raises StateError `upload.not_found`, `upload.busy`."""
    services.uploads.get(workspace, upload_id)  # or a file would be made for any id
    with partial_file(services.uploads_dir, upload_id) as file, request_folder(services.incoming_dir) as folder:
        yield LockedUpload(services, workspace, services.uploads.get(workspace, upload_id), file, folder)
