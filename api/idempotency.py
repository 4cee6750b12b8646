"""The header `Idempotency-Key`: a request sent twice is done once (draft-ietf-httpapi-idempotency-key-header)."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable
from typing import Any, TypeVar

from sqlalchemy.orm import Session

from api.services import Services
from core.errors import InputError, StateError
from store.idempotency import OvertakenError, Reply
from store.workspace import WorkspaceId

HEADER = "Idempotency-Key"
REPLAYED = "Idempotent-Replayed"
T = TypeVar("T")
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

    def answer(self, work: Callable[[], T], replay: Callable[[Any], T]) -> tuple[T, bool]:
        """Do the work, in whose transaction `keep` is called; or `replay` the body that was kept the first time, and True.

        Raises StateError `idempotency.mismatch`."""
        earlier = self._find()
        if earlier is None:
            try:
                return work(), False
            except OvertakenError:
                earlier = self._find()
                if earlier is None:
                    raise StateError("idempotency.in_flight", "the same request is being answered; send it again") from None
        return replay(earlier.body), True

    def keep(self, reply: Reply, session: Session) -> None:
        """Raises OvertakenError, which `answer` sees to."""
        if self._key is not None:
            self._services.keys.keep(self._workspace, self._key, self._fingerprint, reply, session)

    def _find(self) -> Reply | None:
        return None if self._key is None else self._services.keys.find(self._workspace, self._key, self._fingerprint)
