"""A worker says which queues it serves, so that a job nobody takes can be told of.

Safe while older workers run: what says nothing counts as serving both, as those do that are not told otherwise."""

import sqlalchemy as sa
from alembic import op

revision = "v0015"
down_revision: str | None = "v0014"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Add the column."""
    op.add_column("workers", sa.Column("queues", sa.String(length=64), server_default=sa.text("'fast,heavy'"), nullable=False))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("workers", "queues")
