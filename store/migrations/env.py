"""Alembic's entry: runs inside the transaction of `Database.migrate`."""

from alembic import context

from store.records import Record

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Record.metadata,
    transactional_ddl=True,  # also on SQLite, as we begin transactions ourselves: a migration happens whole or not at all
    render_as_batch=True,
)
context.run_migrations()
