"""Uploads may be label volumes; their rows tell voxels and labels."""

import sqlalchemy as sa
from alembic import op

revision = "v0014"
down_revision: str | None = "v0013"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Add the column; meshes have none."""
    op.add_column("meshes", sa.Column("volume", sa.JSON(), nullable=True))


def downgrade() -> None:
    """Drop it; volumes stay as uploads that no process of the version before can read."""
    op.drop_column("meshes", "volume")
