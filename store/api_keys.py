"""The table of API keys."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from hmac import compare_digest

from sqlalchemy import exists, inspect, select, update
from sqlalchemy.orm import Session

from core.errors import InputError, IntegumentError, StateError
from store.api_key import ApiKey, IssuedKey
from store.database import Database
from store.glance import Glance, Row
from store.key_text import make_key_text, read_key_text
from store.records import ApiKeyRow, WorkspaceRow
from store.scope import Scope
from store.storable import storable_text
from store.workspace import WorkspaceId

USED_S = 60.0  # `last_used_at` is this exact: not every request should write
HELD_KEYS = 1000
_NOBODY = "0" * 64
_ROW = "SELECT digest, * FROM api_keys WHERE id = ?"
_ANY = "SELECT 1 FROM api_keys LIMIT 1"

_log = logging.getLogger(__name__)


class ApiKeys:
    """Keys are never removed: what was done with one can always be told, and a server that once had keys never opens again."""

    def __init__(self, db: Database) -> None:
        self._db = db
        self._any = False
        self._glance = Glance(db)
        self._read: dict[str, tuple[Row, ApiKey]] = {}  # by id: the row as it was found, and what it says

    def close(self) -> None:
        """Close what glances."""
        self._glance.close()

    def create(self, workspace: WorkspaceId, name: str, scopes: Iterable[Scope], lifetime: timedelta | None = None) -> IssuedKey:
        """A new key, which only its SHA-256 stays of here. Raises StateError `workspace.not_found`."""
        with self._db.session() as session:
            if session.get(WorkspaceRow, workspace) is None:
                raise StateError("workspace.not_found", f"there is no workspace {workspace[:80]}", workspace=workspace[:80])
            return _issue(session, workspace, name, scopes, lifetime, self._db.now(session))

    def list(self, workspace: WorkspaceId | None = None) -> Sequence[ApiKey]:
        """The newest first; of all workspaces, or of one."""
        query = select(ApiKeyRow).order_by(ApiKeyRow.created_at.desc(), ApiKeyRow.id)
        if workspace is not None:
            query = query.where(ApiKeyRow.workspace == workspace)
        with self._db.reading() as session:
            return [_key(row) for row in session.scalars(query)]

    def rotate(self, key_id: str, overlap: timedelta) -> IssuedKey:
        """A successor with the same rights and lifetime; both are good for `overlap`, then the old one expires.

        Raises StateError `key.not_found`, `key.not_live`, `key.rotated`."""
        with self._db.session() as session:
            row, now = _known(session, key_id), self._db.now(session)
            state = _key(row).state_at(now)
            if state != "live":
                raise StateError("key.not_live", f"key {key_id} is {state}; create a new one", key=key_id, state=state)
            if row.replaced_by is not None:
                raise StateError(
                    "key.rotated", f"key {key_id} was rotated before, to {row.replaced_by}", key=key_id, successor=row.replaced_by
                )
            lifetime = None if row.expires_at is None else row.expires_at - row.created_at
            issued = _issue(session, WorkspaceId(row.workspace), row.name, map(Scope, row.scopes), lifetime, now)
            row.replaced_by = issued.key.id
            row.expires_at = min(filter(None, (row.expires_at, now + overlap)))
            return issued

    def revoke(self, key_id: str) -> ApiKey:
        """From the next request on it is worth nothing. Raises StateError `key.not_found`."""
        with self._db.session() as session:
            row = _known(session, key_id)
            row.revoked_at = row.revoked_at or self._db.now(session)
            return _key(row)

    def authenticate(self, sent: str) -> ApiKey:
        """The live key with this text.

        Raises InputError `access.key_invalid` (no such key, or revoked), `access.key_expired`."""
        text = read_key_text(sent)
        if text is None:
            raise _invalid()
        before = self._glance.row(_ROW, (text.id,))
        with self._db.reading() as session:
            row = session.get(ApiKeyRow, text.id)
            # compared also where there is nothing to compare with: the time it takes tells nothing about ids
            proven = compare_digest(row.digest if row is not None else _NOBODY, text.digest)
            if row is None or not proven or row.revoked_at is not None:
                raise _invalid()
            key, now = _key(row), self._db.now(session)
        if key.expires_at is not None and key.expires_at <= now:
            raise InputError("access.key_expired", f"key {key.id} expired on {key.expires_at:%Y-%m-%d %H:%M} UTC", key=key.id)
        if key.last_used_at is None or now - key.last_used_at > timedelta(seconds=USED_S):
            self._note_use(key.id, now)
        elif before and before == self._glance.row(_ROW, (text.id,)):
            self._hold(before, key)
        return key

    def authenticate_at_once(self, sent: str) -> ApiKey | None:
        """The same without waiting for anything, by one look at the row as it is now; None if that takes longer, or is a refusal.

        It takes longer whenever a character of the row has changed since `authenticate` read it."""
        text = read_key_text(sent)
        if text is None or not (row := self._glance.row(_ROW, (text.id,))):
            return None
        held = self._read.get(text.id)
        if held is None or held[0] != row:
            return None
        key, now = held[1], datetime.now(UTC)
        proven = compare_digest(str(row[0]), text.digest)
        fresh = key.last_used_at is not None and now - key.last_used_at <= timedelta(seconds=USED_S)
        return key if proven and fresh and key.state_at(now) == "live" else None

    def _hold(self, row: Row, key: ApiKey) -> None:
        if len(self._read) >= HELD_KEYS:
            self._read.clear()
        self._read[key.id] = (row, key)

    def none_at_once(self) -> bool:
        """True if there is no key, and that can be told at once."""
        return not self._any and self._glance.row(_ANY) == ()

    def is_live(self, key_id: str) -> bool:
        """True if requests with this key are still served."""
        with self._db.reading() as session:
            row = session.get(ApiKeyRow, key_id)
            return row is not None and _key(row).state_at(self._db.now(session)) == "live"

    def any(self, *, before_migration: bool = False) -> bool:
        """True once a key was made, whatever became of it. `before_migration`: there may be no such table yet."""
        if not self._any:
            with self._db.reading() as session:
                if before_migration and not inspect(session.connection()).has_table(ApiKeyRow.__tablename__):
                    return False
                self._any = bool(session.scalar(select(exists().select_from(ApiKeyRow))))
        return self._any

    def _note_use(self, key_id: str, now: datetime) -> None:
        try:
            with self._db.session() as session:
                session.execute(update(ApiKeyRow).where(ApiKeyRow.id == key_id).values(last_used_at=now))
        except IntegumentError as error:  # a full disk must not keep anybody from reading
            _log.warning("the use of key %s cannot be noted: %s", key_id, error)


def _issue(
    session: Session,
    workspace: WorkspaceId,
    name: str,
    scopes: Iterable[Scope],
    lifetime: timedelta | None,
    now: datetime,
) -> IssuedKey:
    text = make_key_text()
    row = ApiKeyRow(
        id=text.id,
        workspace=workspace,
        name=storable_text(name, 200),
        scopes=sorted({scope.value for scope in scopes}),
        digest=text.digest,
        created_at=now,
        expires_at=None if lifetime is None else now + lifetime,
        last_used_at=None,
        revoked_at=None,
        replaced_by=None,
    )
    session.add(row)
    session.flush()
    return IssuedKey(_key(row), text.text)


def _known(session: Session, key_id: str) -> ApiKeyRow:
    row = session.get(ApiKeyRow, key_id, with_for_update=True)
    if row is None:
        raise StateError("key.not_found", f"there is no key {key_id[:40]}", key=key_id[:40])
    return row


def _invalid() -> InputError:
    return InputError("access.key_invalid", "this is no key of this server, or it was revoked")


def _key(row: ApiKeyRow) -> ApiKey:
    return ApiKey(
        id=row.id,
        workspace=WorkspaceId(row.workspace),
        name=row.name,
        scopes=frozenset(map(Scope, row.scopes)),
        created_at=row.created_at,
        expires_at=row.expires_at,
        last_used_at=row.last_used_at,
        revoked_at=row.revoked_at,
        replaced_by=row.replaced_by,
    )
