"""Every test of the store that takes `db` runs twice: on SQLite and on a real PostgreSQL."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import text

from store.database import Database
from store.events import Events
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.record import Record
from store.records import WorkspaceRow
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.postgres import PostgresServer


@pytest.fixture(scope="session")
def postgres_settings(postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory) -> Settings:
    """One migrated database, emptied before each test that uses it."""
    settings = Settings(data_dir=tmp_path_factory.mktemp("data"), database_url=postgres.new_database())
    database = Database(settings)
    database.migrate()
    database.close()
    return settings


@pytest.fixture(params=["sqlite", "postgresql"])
def settings(request: pytest.FixtureRequest, tmp_path: Path) -> Settings:
    """Settings of a migrated, empty database."""
    if request.param == "sqlite":
        made = Settings(data_dir=tmp_path)
        database = Database(made)
        database.migrate()
    else:
        made = request.getfixturevalue("postgres_settings")
        database = Database(made)
        with database.session() as session:
            session.execute(text("TRUNCATE " + ", ".join(Record.metadata.tables)))
            session.add(WorkspaceRow(id=DEFAULT_WORKSPACE, created_at=database.now(session)))  # as the migration does
    database.close()
    return made


@pytest.fixture
def db(settings: Settings) -> Iterator[Database]:
    """An open database, empty."""
    database = Database(settings)
    yield database
    database.close()


@pytest.fixture
def jobs(db: Database) -> Jobs:
    """The job table."""
    return Jobs(db)


@pytest.fixture
def events(db: Database) -> Events:
    """The events of its jobs."""
    return Events(db)


@pytest.fixture
def blobs(tmp_path: Path) -> LocalBlobs:
    """An empty blob store."""
    return LocalBlobs(tmp_path / "blobs")
