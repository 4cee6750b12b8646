"""Uploads may be fields and coils; their rows tell what there is in them."""

import sqlalchemy as sa
from alembic import op

revision = "v0016"
down_revision: str | None = "v0015"
branch_labels: str | None = None
depends_on: str | None = None

COLUMNS = ("field", "coil")


def upgrade() -> None:
    """Add the columns; meshes have none."""
    for name in COLUMNS:
        op.add_column("meshes", sa.Column(name, sa.JSON(), nullable=True))


def downgrade() -> None:
    """Drop them; fields and coils stay as uploads that no process of the version before can read."""
    for name in COLUMNS:
        op.drop_column("meshes", name)
