"""One PATCH request of an upload in pieces."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from contextlib import closing
from functools import partial

from starlette.concurrency import run_in_threadpool

from api.one_behind import OneBehind
from api.partial_file import partial_file
from api.request_body import RequestBody
from api.services import Services
from api.tus import Checksum
from api.upload_target import UploadTarget, upload_target
from core.errors import InputError, IntegumentError, LimitError, StateError
from store.uploads import Upload
from store.workspace import WorkspaceId


class Receiving:
    """Takes the bytes of one request, a piece at a time."""

    def __init__(
        self, services: Services, workspace: WorkspaceId, upload_id: str, body: RequestBody, checksum: Checksum | None
    ) -> None:
        self._services = services
        self._workspace = workspace
        self._upload_id = upload_id
        self._body = body
        self._checksum = checksum

    async def run(self, offset: int) -> Upload:
        """Raises StateError `upload.*`, InputError `upload.*`, LimitError `upload.too_large`, `storage.full`."""
        try:
            known = await run_in_threadpool(self._services.uploads.get, self._workspace, self._upload_id)
            with partial_file(self._services.uploads_dir, known.id) as file:
                upload = await run_in_threadpool(self._services.uploads.get, self._workspace, self._upload_id)
                if offset != upload.received:
                    raise StateError(
                        "upload.offset_differs",
                        f"Upload-Offset is {offset}, the server has {upload.received} bytes",
                        received=upload.received,
                    )
                with closing(upload_target(self._services, self._workspace, upload, file)) as target:
                    await run_in_threadpool(target.begin)
                    return await self._receive(target, upload)
        except IntegumentError:
            await self._body.drain()
            raise

    async def _receive(self, target: UploadTarget, upload: Upload) -> Upload:
        digest = self._checksum.new_digest() if self._checksum is not None else None
        begun_at = upload.received
        writing, keeping = OneBehind(), OneBehind()
        try:
            async for chunks in self._body.pieces():
                arrived = upload.received + self._body.size
                if arrived > upload.length:
                    raise LimitError(
                        "upload.too_large", f"{upload.length} bytes were announced, more are coming", length=upload.length
                    )
                await writing.done()
                writing.start(partial(_append, target, digest, chunks))
                if digest is None and arrived - begun_at >= target.kept_every_bytes:
                    begun_at = arrived
                    await writing.done()
                    await keeping.done()
                    keeping.start(target.seal())
            await writing.done()
            await keeping.done()
        except InputError:  # the client went away: what came counts, unless it was to be checked
            await writing.done()
            await keeping.done()  # what lies behind bytes that were lost does not count
            if digest is None:
                await run_in_threadpool(target.seal())
            raise
        finally:  # before anybody closes the file
            await writing.over()
            await keeping.over()
        if self._checksum is not None and digest is not None:
            self._checksum.require(digest)
        return await run_in_threadpool(target.seal())


def _append(target: UploadTarget, digest: hashlib._Hash | None, chunks: Sequence[bytes]) -> None:
    if digest is not None:
        for chunk in chunks:
            digest.update(chunk)
    target.append(chunks)
