"""Checkpoints, lost attempts, parked requests and the reconciler's leader. Going back forgets them: jobs begin anew."""

import sqlalchemy as sa
from alembic import op

revision = "v0009"
down_revision: str | None = "v0008"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Jobs that are there already have no fingerprint: they are resumed by their id alone, and never parked."""
    op.add_column("jobs", sa.Column("fingerprint", sa.String(length=64), nullable=True))
    op.create_index(op.f("ix_jobs_workspace_fingerprint"), "jobs", ["workspace", "fingerprint"])
    op.create_table(
        "job_checkpoints",
        sa.Column("job_id", sa.String(length=36), nullable=False),
        sa.Column("key", sa.String(length=64), nullable=False),
        sa.Column("stage", sa.Text(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name=op.f("fk_job_checkpoints_job_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("job_id", "key", name=op.f("pk_job_checkpoints")),
    )
    op.create_table(
        "job_attempts",
        sa.Column("job_id", sa.String(length=36), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("worker", sa.Text(), nullable=False),
        sa.Column("code", sa.String(length=64), nullable=False),
        sa.Column("message", sa.Text(), nullable=False),
        sa.Column("signal", sa.String(length=32), nullable=True),
        sa.Column("phase", sa.Text(), nullable=False),
        sa.Column("progress", sa.Double(), nullable=False),
        sa.Column("peak_memory_bytes", sa.BigInteger(), nullable=True),
        sa.Column("log", sa.Text(), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("ended_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name=op.f("fk_job_attempts_job_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("job_id", "attempt", name=op.f("pk_job_attempts")),
    )
    op.create_table(
        "parked",
        sa.Column("workspace", sa.String(length=63), nullable=False),
        sa.Column("fingerprint", sa.String(length=64), nullable=False),
        sa.Column("process", sa.String(length=64), nullable=False),
        sa.Column("job_id", sa.String(length=36), nullable=False),
        sa.Column("code", sa.String(length=64), nullable=False),
        sa.Column("evidence", sa.JSON(), nullable=False),
        sa.Column("parked_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["workspace"], ["workspaces.id"], name=op.f("fk_parked_workspace")),
        sa.PrimaryKeyConstraint("workspace", "fingerprint", name=op.f("pk_parked")),
    )
    op.create_index(op.f("ix_parked_job_id"), "parked", ["job_id"])
    op.create_table(
        "leaders",
        sa.Column("office", sa.String(length=32), nullable=False),
        sa.Column("holder", sa.Text(), nullable=False),
        sa.Column("until", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("office", name=op.f("pk_leaders")),
    )


def downgrade() -> None:
    """Drop them."""
    for table in ("leaders", "parked", "job_attempts", "job_checkpoints"):
        op.drop_table(table)
    op.drop_index(op.f("ix_jobs_workspace_fingerprint"), table_name="jobs")
    op.drop_column("jobs", "fingerprint")
