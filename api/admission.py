"""From the headers of a request to what its sender may do."""

from __future__ import annotations

import time

from starlette.datastructures import Headers

from api.access import EMBEDDED, Access
from api.bearer import read_bearer
from core.errors import InputError
from store.api_keys import ApiKeys
from store.scope import Scope

HELD_S = 1.0


class Admission:
    """Keys are asked for once there is one, whatever became of it, or if the settings say so: a server that had keys never
    opens again by itself."""

    def __init__(self, keys: ApiKeys, *, always: bool) -> None:
        self._keys = keys
        self._always = always
        self._held: dict[str | None, tuple[float, bool]] = {}  # by key: when looked at, and whether it was live

    def admit(self, headers: Headers, need: Scope) -> Access:
        """Raises InputError `access.key_missing`, `access.key_invalid`, `access.key_expired`, `access.scope_missing`."""
        if not self._always and not self._keys.any():
            return EMBEDDED
        key = self._keys.authenticate(read_bearer(headers))
        if need not in key.scopes:
            raise InputError(
                "access.scope_missing",
                f"key {key.id} may {', '.join(sorted(key.scopes))}; this request needs the scope {need}",
                key=key.id,
                needed=need.value,
            )
        return Access(key.workspace, key.scopes, key.id)

    def admit_at_once(self, headers: Headers, need: Scope) -> Access | None:
        """The same if it takes no waiting; None if it does, or if he may not: then `admit` says why."""
        if not self._always and self._keys.none_at_once():
            return EMBEDDED
        try:
            key = self._keys.authenticate_at_once(read_bearer(headers))
        except InputError:
            return None
        if key is None or need not in key.scopes:
            return None
        return Access(key.workspace, key.scopes, key.id)

    def close(self) -> None:
        """Close what looks keys up."""
        self._keys.close()

    def holds(self, access: Access) -> bool:
        """True while the sender of an earlier request would still be let in; asked by what lasts, as event streams do.

        Many streams of one key ask within the same second: one look serves them."""
        now = time.monotonic()
        looked_at, held = self._held.get(access.key_id, (-HELD_S, False))
        if now - looked_at >= HELD_S:
            held = self._keys.is_live(access.key_id) if access.key_id is not None else not (self._always or self._keys.any())
            self._held[access.key_id] = now, held
        return held
