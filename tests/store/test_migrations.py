"""The migrations make exactly the tables of `store.records`, and take them away again, on both databases."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import CheckConstraint, inspect

from store.database import Database
from store.record import Record
from store.settings import Settings
from tests.postgres import PostgresServer


@pytest.fixture(params=["sqlite", "postgresql"])
def empty(request: pytest.FixtureRequest, tmp_path: Path) -> Settings:
    """Settings of a database without any table."""
    if request.param == "sqlite":
        return Settings(data_dir=tmp_path)
    server: PostgresServer = request.getfixturevalue("postgres")
    return Settings(data_dir=tmp_path, database_url=server.new_database())


def tables(database: Database) -> set[str]:
    return set(inspect(database.engine).get_table_names()) - {"alembic_version"}


def test_up_makes_what_the_records_say_and_down_takes_it_away(empty: Settings) -> None:
    database = Database(empty)
    assert not database.is_migrated()
    for _ in range(2):
        database.migrate()
        assert database.is_migrated()
        assert tables(database) == set(Record.metadata.tables)
        with database.engine.begin() as connection:
            options = {"compare_type": True, "compare_server_default": True}
            context = MigrationContext.configure(connection, opts=options)
            assert compare_metadata(context, Record.metadata) == []
        database.migrate()  # again: nothing to do
        database.revert("base")
        assert not database.is_migrated()
        assert tables(database) == set()
    database.close()


def test_constraints_are_in_the_tables_too(empty: Settings) -> None:
    """Alembic's comparison does not see check constraints."""
    database = Database(empty)
    database.migrate()
    checks = {str(check["name"]) for check in inspect(database.engine).get_check_constraints("jobs")}
    database.close()
    declared = {str(item.name) for item in Record.metadata.tables["jobs"].constraints if isinstance(item, CheckConstraint)}
    assert checks == declared
    assert len(declared) == 2


STARTER = """
import sys
from concurrent.futures import ThreadPoolExecutor
from store.database import Database
from store.settings import Settings

databases = [Database(Settings()) for _ in range(3)]
print("ready", flush=True)
sys.stdin.readline()
with ThreadPoolExecutor() as pool:
    list(pool.map(Database.migrate, databases))
"""


def test_processes_that_start_together_migrate_once(empty: Settings) -> None:
    starters = [
        subprocess.Popen(
            [sys.executable, "-c", STARTER],
            env={**os.environ, **empty.as_environment()},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(3)
    ]
    for starter in starters:
        assert starter.stdout is not None
        assert starter.stdout.readline() == "ready\n"
    for starter in starters:
        assert starter.stdin is not None
        starter.stdin.write("go\n")
        starter.stdin.flush()
    errors = [starter.communicate(timeout=60)[1] for starter in starters]
    assert [starter.returncode for starter in starters] == [0] * len(starters), "\n".join(errors)
    database = Database(empty)
    assert database.is_migrated()
    database.close()


def test_a_migration_that_breaks_leaves_nothing(empty: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    database = Database(empty)

    def break_off(*_: object, **__: object) -> None:
        raise RuntimeError("on purpose")

    monkeypatch.setattr("alembic.runtime.migration.HeadMaintainer.update_to_step", break_off)  # after the tables were made
    with pytest.raises(RuntimeError, match="on purpose"):
        database.migrate()
    assert tables(database) == set()
    monkeypatch.undo()
    database.migrate()
    assert database.is_migrated()
    database.close()
