"""`python -m store.migrate`: bring the database's tables to what this version expects, then end. Safe to repeat."""

from __future__ import annotations

import sys

from pydantic import ValidationError

from core.errors import IntegumentError
from store.database import Database
from store.settings import Settings


def main() -> int:
    """0 when the tables are right, 1 if the database does not answer, 2 if the settings are at fault."""
    try:
        database = Database(Settings())
    except ValidationError as error:
        print(f"python -m store.migrate: {error}", file=sys.stderr)
        return 2
    try:
        database.migrate()
    except IntegumentError as error:
        print(f"python -m store.migrate: {error.message} [{error.code}]", file=sys.stderr)
        return 1
    finally:
        database.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
