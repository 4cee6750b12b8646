"""Meshes tell which numbers they have for each vertex."""

import sqlalchemy as sa
from alembic import op

revision = "v0002"
down_revision: str | None = "v0001"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Add the column; meshes that are there already have none."""
    op.add_column("meshes", sa.Column("arrays", sa.JSON(), nullable=True))


def downgrade() -> None:
    """Drop it."""
    op.drop_column("meshes", "arrays")
