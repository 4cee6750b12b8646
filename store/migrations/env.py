"""Alembic's entry: runs inside the transaction of `Database.migrate`."""

from alembic import context

import store.crew_records
import store.records  # noqa: F401
from store.record import Record

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Record.metadata,
    render_as_batch=True,
)
context.run_migrations()
