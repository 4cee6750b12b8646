"""Uploads whose pieces are blobs. Going back forgets what those that are under way have sent so."""

import sqlalchemy as sa
from alembic import op

revision = "v0011"
down_revision: str | None = "v0010"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "upload_parts",
        sa.Column("upload_id", sa.String(length=36), nullable=False),
        sa.Column("start", sa.BigInteger(), autoincrement=False, nullable=False),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.ForeignKeyConstraint(["upload_id"], ["uploads.id"], name=op.f("fk_upload_parts_upload_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("upload_id", "start", name=op.f("pk_upload_parts")),
    )


def downgrade() -> None:
    """Drop it, and begin again what was sent in parts."""
    op.execute(sa.text("UPDATE uploads SET received = 0 WHERE id IN (SELECT upload_id FROM upload_parts)"))
    op.drop_table("upload_parts")
