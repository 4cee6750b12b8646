"""Whether the tables are those this version was written for."""

from __future__ import annotations

from core.errors import StateError
from store.database import Database


def require_own_schema(db: Database) -> None:
    """Raises StateError `database.schema_older`, `database.schema_newer`; InternalError `database.unavailable`."""
    if db.is_migrated():
        return
    revision = db.revision()
    if revision and not db.knows(revision):
        raise StateError(
            "database.schema_newer",
            f"the tables are of revision {revision}, made by a newer version than this; install that one here, too",
            revision=revision,
        )
    raise StateError(
        "database.schema_older",
        f"the tables are of revision {revision or 'none'}, older than this version: run `python -m store.migrate`",
        revision=revision,
    )
