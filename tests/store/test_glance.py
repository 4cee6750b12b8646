"""One row at once, as it was committed last."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path

from store.api_keys import ApiKeys
from store.database import Database
from store.glance import Glance
from store.scope import Scope
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces

QUERY = "SELECT id FROM workspaces WHERE id = ?"


def opened(folder: Path) -> Database:
    folder.mkdir(exist_ok=True)
    database = Database(Settings(data_dir=folder))
    database.migrate()
    return database


def test_what_another_connection_committed_is_seen(tmp_path: Path) -> None:
    database = opened(tmp_path / "a #1 %20?")  # a folder may have any name
    glance = Glance(database)
    assert glance.row(QUERY, ("lab",)) == ()
    with database.session() as session:
        Workspaces(database)
        session.connection().exec_driver_sql(
            "INSERT INTO workspaces (id, created_at) VALUES ('lab', '2026-01-01 00:00:00.000000')"
        )
        assert glance.row(QUERY, ("lab",)) == ()  # and it waits for no writer
    assert glance.row(QUERY, ("lab",)) == ("lab",)
    glance.close()
    assert glance.row(QUERY, ("lab",)) == ("lab",)  # closed things open again
    glance.close()
    database.close()


def test_what_cannot_be_had_at_once_is_none(tmp_path: Path, postgres_settings: Settings) -> None:
    elsewhere = Database(postgres_settings)
    assert Glance(elsewhere).row(QUERY, ("default",)) is None
    elsewhere.close()
    empty = Database(Settings(data_dir=tmp_path))  # no file yet
    assert Glance(empty).row(QUERY, ("default",)) is None
    empty.migrate()
    assert Glance(empty).row(QUERY, ("default",)) == ("default",)
    assert Glance(empty).row("SELECT 1 FROM no_such_table") is None
    empty.close()


def test_a_key_is_known_at_once_until_its_row_changes(tmp_path: Path) -> None:
    database, elsewhere = opened(tmp_path), Database(Settings(data_dir=tmp_path))
    keys, others = ApiKeys(database), ApiKeys(elsewhere)  # as an operator's command in another process
    assert keys.none_at_once()
    issued = others.create(WorkspaceId(DEFAULT_WORKSPACE), "robot", [Scope.READ])
    assert not keys.none_at_once()
    assert keys.authenticate_at_once(issued.text) is None  # never read before
    for _ in range(2):  # its first use is written down, which changes its row
        keys.authenticate(issued.text)
    known = keys.authenticate_at_once(issued.text)
    assert known is not None
    assert known.id == issued.key.id
    assert keys.authenticate_at_once(issued.text[:-8] + "AA" + issued.text[-6:]) is None
    others.revoke(issued.key.id)
    assert keys.authenticate_at_once(issued.text) is None
    keys.close()
    others.close()
    elsewhere.close()
    database.close()


def test_an_expired_key_is_not_known_at_once(tmp_path: Path) -> None:
    database = opened(tmp_path)
    keys = ApiKeys(database)
    issued = keys.create(WorkspaceId(DEFAULT_WORKSPACE), "short", [Scope.READ], timedelta(hours=1))
    for _ in range(2):
        keys.authenticate(issued.text)
    assert keys.authenticate_at_once(issued.text) is not None
    row, key = keys._read[issued.key.id]
    from dataclasses import replace

    assert key.expires_at is not None
    keys._read[issued.key.id] = (row, replace(key, expires_at=key.expires_at - timedelta(hours=2)))
    assert keys.authenticate_at_once(issued.text) is None
    keys.close()
    database.close()
