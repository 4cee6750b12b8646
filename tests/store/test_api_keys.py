"""API keys: their form, their life, and what the database knows of them, on both databases."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import text, update

from core.errors import InputError, StateError
from store.api_key import IssuedKey
from store.api_keys import ApiKeys
from store.database import Database
from store.key_text import make_key_text, read_key_text, without_secrets
from store.records import ApiKeyRow
from store.scope import Scope
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces

DAY = timedelta(days=1)


@pytest.fixture
def keys(db: Database) -> ApiKeys:
    return ApiKeys(db)


def issue(keys: ApiKeys, lifetime: timedelta | None = None) -> IssuedKey:
    return keys.create(DEFAULT_WORKSPACE, "robot", [Scope.READ, Scope.SUBMIT], lifetime)


def code_of(act: Callable[[], object]) -> str:
    with pytest.raises((InputError, StateError)) as caught:
        act()
    return caught.value.code


def shift(db: Database, key_id: str, **columns: timedelta) -> None:
    """Move moments of a key into the past."""
    with db.session() as session:
        now = db.now(session)
        values = {name: now - by for name, by in columns.items()}
        session.execute(update(ApiKeyRow).where(ApiKeyRow.id == key_id).values(**values))


def test_a_key_has_an_id_a_secret_and_a_checksum() -> None:
    made = [make_key_text() for _ in range(200)]
    assert all(re.fullmatch(r"itg_[0-9A-Za-z]{12}_[0-9A-Za-z]{43}_[0-9A-Za-z]{6}", key.text) for key in made)
    assert all(read_key_text(key.text) == key for key in made)
    assert len({key.text.split("_")[2] for key in made}) == 200
    assert all(key.text not in repr(key) for key in made)
    assert made[0].digest == hashlib.sha256(made[0].text.encode()).hexdigest()


def test_a_mistyped_key_is_told_by_its_checksum() -> None:
    key = make_key_text().text
    for position in range(4, len(key)):
        if key[position] != "_":
            other = "x" if key[position] != "x" else "y"
            assert read_key_text(key[:position] + other + key[position + 1 :]) is None
    for wrong in ("", "itg", key[:-1], key + "0", " " + key, key.replace("itg", "itg2"), key.upper(), key + "\n", "é" + key):
        assert read_key_text(wrong) is None


def test_secrets_are_taken_out_of_texts() -> None:
    key = make_key_text()
    secret = key.text.split("_")[2]
    for said in (key.text, f"GET /v1/jobs/{key.text}?key={key.text}", f"'{key.text[:-9]}'", f"{key.text}{key.text}"):
        assert secret[:20] not in without_secrets(said)
        assert key.id in without_secrets(said)
    assert without_secrets("nothing itg_here") == "nothing itg_here"


def test_what_is_stored_cannot_be_sent(keys: ApiKeys, db: Database) -> None:
    issued = issue(keys)
    with db.reading() as session:
        row = repr(session.execute(text("SELECT * FROM api_keys")).one())
    assert issued.text not in row
    assert issued.text.split("_")[2] not in row
    assert hashlib.sha256(issued.text.encode()).hexdigest() in row
    assert issued.text not in repr(issued)


def test_only_the_whole_key_opens(keys: ApiKeys) -> None:
    assert not keys.any()
    issued, other = issue(keys), issue(keys)
    assert keys.any()
    found = keys.authenticate(issued.text)
    assert (found.id, found.workspace, found.scopes) == (issued.key.id, DEFAULT_WORKSPACE, {Scope.READ, Scope.SUBMIT})
    # the id of one key with the secret of another, and a well-formed key nobody made
    mixed = make_key_text()
    for wrong in ("", "itg_", issued.text[:-1], mixed.text, issued.text.replace(issued.key.id, other.key.id)):
        assert code_of(lambda wrong=wrong: keys.authenticate(wrong)) == "access.key_invalid"  # type: ignore[misc]


def test_a_key_expires_and_says_so_only_to_whoever_has_it(keys: ApiKeys, db: Database) -> None:
    issued = issue(keys, DAY)
    assert keys.is_live(issued.key.id)
    shift(db, issued.key.id, expires_at=timedelta(seconds=1))
    assert code_of(lambda: keys.authenticate(issued.text)) == "access.key_expired"
    assert not keys.is_live(issued.key.id)
    assert keys.any(), "a server that had keys does not open again"


def test_a_revoked_key_is_worth_nothing(keys: ApiKeys) -> None:
    issued = issue(keys)
    revoked = keys.revoke(issued.key.id)
    assert revoked.revoked_at is not None
    assert keys.revoke(issued.key.id).revoked_at == revoked.revoked_at
    assert code_of(lambda: keys.authenticate(issued.text)) == "access.key_invalid"
    assert not keys.is_live(issued.key.id)
    assert keys.any()
    assert code_of(lambda: keys.rotate(issued.key.id, DAY)) == "key.not_live"
    assert code_of(lambda: keys.revoke("nobody")) == "key.not_found"


def test_rotation_leaves_two_live_keys_for_a_while(keys: ApiKeys, db: Database) -> None:
    old = issue(keys, 90 * DAY)
    new = keys.rotate(old.key.id, DAY)
    assert (new.key.workspace, new.key.name, new.key.scopes) == (old.key.workspace, old.key.name, old.key.scopes)
    assert new.key.expires_at is not None
    assert new.key.expires_at - new.key.created_at == 90 * DAY
    assert {keys.authenticate(one.text).id for one in (old, new)} == {old.key.id, new.key.id}
    (before,) = [key for key in keys.list() if key.id == old.key.id]
    assert before.replaced_by == new.key.id
    assert before.expires_at is not None
    assert before.expires_at <= new.key.created_at + DAY
    assert code_of(lambda: keys.rotate(old.key.id, DAY)) == "key.rotated"
    shift(db, old.key.id, expires_at=timedelta(0))
    assert code_of(lambda: keys.authenticate(old.text)) == "access.key_expired"
    assert keys.authenticate(new.text).id == new.key.id


def test_rotation_does_not_prolong_a_key_that_ends_sooner(keys: ApiKeys) -> None:
    old = issue(keys, timedelta(hours=1))
    keys.rotate(old.key.id, 7 * DAY)
    (before,) = [key for key in keys.list() if key.id == old.key.id]
    assert before.expires_at == old.key.expires_at


def test_use_is_noted_but_not_with_every_request(keys: ApiKeys, db: Database) -> None:
    issued = issue(keys)
    assert keys.list()[0].last_used_at is None
    keys.authenticate(issued.text)
    first = keys.list()[0].last_used_at
    assert first is not None
    keys.authenticate(issued.text)
    assert keys.list()[0].last_used_at == first
    shift(db, issued.key.id, last_used_at=timedelta(seconds=61))
    keys.authenticate(issued.text)
    later = keys.list()[0].last_used_at
    assert later is not None
    assert later >= first


def test_keys_belong_to_workspaces_that_are_there(keys: ApiKeys, db: Database) -> None:
    assert code_of(lambda: keys.create(WorkspaceId("nowhere"), "", [Scope.READ])) == "workspace.not_found"
    lab = Workspaces(db).create("lab").id
    issued = keys.create(lab, "", [Scope.ADMIN])
    issue(keys)
    assert [key.id for key in keys.list(lab)] == [issued.key.id]
    assert len(keys.list()) == 2


def test_a_database_without_tables_has_no_keys(tmp_path: Path) -> None:
    database = Database(Settings(data_dir=tmp_path))
    assert not ApiKeys(database).any(before_migration=True)
    database.close()
