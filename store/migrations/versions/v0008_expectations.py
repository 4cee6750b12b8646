"""What jobs are expected to need, and whose turn it is.

Safe while older APIs and workers run: every new column has a default of its own, and none of the old ones changes.
Going back forgets both; jobs stay."""

import sqlalchemy as sa
from alembic import op

revision = "v0008"
down_revision: str | None = "v0007"
branch_labels: str | None = None
depends_on: str | None = None

WAITING = ["workspace", "status", "queue", "queued_at", "id"]


def upgrade() -> None:
    """Jobs accepted before are of unknown need: heavy, 1 GiB."""
    op.add_column("jobs", sa.Column("queue", sa.String(length=8), server_default="heavy", nullable=False))
    op.add_column(
        "jobs", sa.Column("expected_memory_bytes", sa.BigInteger(), server_default=sa.text("1073741824"), nullable=False)
    )
    op.add_column("jobs", sa.Column("expected_cpu_s", sa.Double(), nullable=True))
    op.drop_index(op.f("ix_jobs_workspace_status"), table_name="jobs")
    op.create_index(op.f("ix_jobs_workspace_status_queue_queued_at_id"), "jobs", WAITING)
    op.create_table(
        "turns",
        sa.Column("workspace", sa.String(length=63), nullable=False),
        sa.Column("served_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["workspace"], ["workspaces.id"], name=op.f("fk_turns_workspace")),
        sa.PrimaryKeyConstraint("workspace", name=op.f("pk_turns")),
    )


def downgrade() -> None:
    """Jobs stay as they are and wait in the one queue of the older version."""
    op.drop_table("turns")
    op.drop_index(op.f("ix_jobs_workspace_status_queue_queued_at_id"), table_name="jobs")
    op.create_index(op.f("ix_jobs_workspace_status"), "jobs", ["workspace", "status"])
    op.drop_column("jobs", "expected_cpu_s")
    op.drop_column("jobs", "expected_memory_bytes")
    op.drop_column("jobs", "queue")
