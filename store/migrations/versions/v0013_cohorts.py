"""Cohorts: one request for many subjects.

Safe while older APIs and workers run: the new columns may be null. When an older worker ends the last job of a cohort, the
reconciler of a newer one queues the summary. Going back forgets the cohorts; their jobs stay."""

import sqlalchemy as sa
from alembic import op

revision = "v0013"
down_revision: str | None = "v0012"
branch_labels: str | None = None
depends_on: str | None = None


def upgrade() -> None:
    """Make the table, and say of a job whose it is."""
    op.create_table(
        "cohorts",
        sa.Column("id", sa.String(length=36), nullable=False),
        sa.Column("workspace", sa.String(length=63), nullable=False),
        sa.Column("process", sa.String(length=64), nullable=False),
        sa.Column("name", sa.Text(), nullable=True),
        sa.Column("labels", sa.JSON(), nullable=True),
        sa.Column("inputs", sa.JSON(), nullable=False),
        sa.Column("subjects", sa.Integer(), nullable=False),
        sa.Column("refused", sa.JSON(), nullable=False),
        sa.Column("subscriber", sa.JSON(), nullable=True),
        sa.Column("round", sa.Integer(), nullable=False),
        sa.Column("summary_job_id", sa.String(length=36), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=True),
        sa.ForeignKeyConstraint(["workspace"], ["workspaces.id"], name=op.f("fk_cohorts_workspace")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_cohorts")),
    )
    op.create_index(op.f("ix_cohorts_workspace_created_at_id"), "cohorts", ["workspace", "created_at", "id"])
    op.create_index(op.f("ix_cohorts_finished_at"), "cohorts", ["finished_at"])
    op.add_column("jobs", sa.Column("cohort_id", sa.String(length=36), nullable=True))
    op.add_column("jobs", sa.Column("subject", sa.Text(), nullable=True))
    op.create_index(op.f("ix_jobs_cohort_id_created_at_id"), "jobs", ["cohort_id", "created_at", "id"])


def downgrade() -> None:
    """Drop them."""
    op.drop_index(op.f("ix_jobs_cohort_id_created_at_id"), table_name="jobs")
    op.drop_column("jobs", "subject")
    op.drop_column("jobs", "cohort_id")
    op.drop_table("cohorts")
