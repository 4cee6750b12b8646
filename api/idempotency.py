"""The header `Idempotency-Key`: a request sent twice is done once (draft-ietf-httpapi-idempotency-key-header)."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sqlalchemy.orm import Session

from api.services import Services
from core.errors import InputError
from store.idempotency import Reply
from store.workspace import WorkspaceId

HEADER = "Idempotency-Key"
REPLAYED = "Idempotent-Replayed"
_KEY = re.compile(r"[\x21-\x7e]{1,255}")


def fingerprint_of(method: str, path: str, body: Any) -> str:
    """What makes two requests the same: `body` is JSON, its order of keys does not matter."""
    told = json.dumps([method, path, body], sort_keys=True, allow_nan=True)
    return hashlib.sha256(told.encode("utf-8", "backslashreplace")).hexdigest()


class Once:
    """One request under its key. Without a key everything is done as if this were not here."""

    def __init__(self, services: Services, workspace: WorkspaceId, key: str | None, fingerprint: str) -> None:
        if key is not None and not _KEY.fullmatch(key):
            raise InputError(
                "idempotency.key_invalid", f"{HEADER} has {len(key)} characters; it takes 1 to 255 visible ASCII characters"
            )
        self._services = services
        self._workspace = workspace
        self._key = key
        self._fingerprint = fingerprint

    @contextmanager
    def attempt(self) -> Iterator[Reply | None]:
        """Yields the first reply if there was one, else None; then the block does the work, and forgets the key if it fails.

        Raises StateError `idempotency.mismatch`, `idempotency.in_flight`."""
        if self._key is None:
            yield None
            return
        earlier = self._services.keys.begin(self._workspace, self._key, self._fingerprint)
        if earlier is not None:
            yield earlier
            return
        try:
            yield None
        except BaseException:
            self._services.keys.abandon(self._workspace, self._key)
            raise

    def remember(self, reply: Reply, session: Session | None = None) -> None:
        """Keep the reply; in the transaction that does the work, if there is one."""
        if self._key is not None:
            self._services.keys.complete(self._workspace, self._key, reply, session=session)
