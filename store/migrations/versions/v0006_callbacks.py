"""Subscribers of jobs, and what is sent to them. Going back forgets both: the older server sends nothing."""

import sqlalchemy as sa
from alembic import op

revision = "v0006"
down_revision: str | None = "v0005"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Make the table; jobs that are there already have no subscriber."""
    op.add_column("jobs", sa.Column("subscriber", sa.JSON(), nullable=True))
    op.create_table(
        "callbacks",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("workspace", sa.String(length=63), nullable=False),
        sa.Column("job_id", sa.String(length=36), nullable=False),
        sa.Column("event", sa.String(length=16), nullable=False),
        sa.Column("uri", sa.Text(), nullable=False),
        sa.Column("body", sa.Text(), nullable=False),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("lease_token", sa.Integer(), nullable=False),
        sa.Column("lease_until", sa.DateTime(timezone=True), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("due_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("ended_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("last_status", sa.Integer(), nullable=True),
        sa.Column("last_error", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name=op.f("fk_callbacks_job_id"), ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["workspace"], ["workspaces.id"], name=op.f("fk_callbacks_workspace")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_callbacks")),
    )
    op.create_index(op.f("ix_callbacks_job_id"), "callbacks", ["job_id"])
    op.create_index(op.f("ix_callbacks_state_due_at"), "callbacks", ["state", "due_at"])


def downgrade() -> None:
    """Drop both."""
    op.drop_index(op.f("ix_callbacks_state_due_at"), table_name="callbacks")
    op.drop_index(op.f("ix_callbacks_job_id"), table_name="callbacks")
    op.drop_table("callbacks")
    op.drop_column("jobs", "subscriber")
