"""One PATCH request of an upload in pieces."""

from __future__ import annotations

import asyncio
from contextlib import closing

from starlette.concurrency import run_in_threadpool

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
        keeping: asyncio.Task[Upload] | None = None
        try:
            async for piece in self._body.pieces():
                if target.received + len(piece) > upload.length:
                    raise LimitError(
                        "upload.too_large", f"{upload.length} bytes were announced, more are coming", length=upload.length
                    )
                if digest is not None:
                    digest.update(piece)
                await run_in_threadpool(target.append, piece)
                if digest is None and target.received - begun_at >= target.kept_every_bytes:
                    if keeping is not None:
                        await keeping
                    begun_at = target.received
                    keeping = asyncio.create_task(run_in_threadpool(target.seal()))
        except InputError:  # the client went away: what came counts, unless it was to be checked
            if keeping is not None:
                await keeping  # what lies behind bytes that were lost does not count
            if digest is None:
                await run_in_threadpool(target.seal())
            raise
        finally:
            await _done(keeping)  # before anybody closes the file
        if keeping is not None:
            await keeping
        if self._checksum is not None and digest is not None:
            self._checksum.require(digest)
        return await run_in_threadpool(target.seal())


async def _done(task: asyncio.Task[Upload] | None) -> None:
    """Over, well or not."""
    if task is not None:
        await asyncio.wait([task])
