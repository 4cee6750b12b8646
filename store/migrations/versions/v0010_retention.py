"""How long each workspace keeps what is done. Going back forgets the days: nothing is removed by itself any more."""

import sqlalchemy as sa
from alembic import op

revision = "v0010"
down_revision: str | None = "v0009"
branch_labels: str | None = None
depends_on: str | None = None

DAYS = ("keep_jobs_days", "keep_meshes_days", "keep_events_days")


def upgrade() -> None:
    """Workspaces that are there already follow the settings."""
    for name in DAYS:
        op.add_column("workspaces", sa.Column(name, sa.Double(), nullable=True))
    op.add_column("jobs", sa.Column("events_trimmed_at", sa.DateTime(timezone=True), nullable=True))
    op.create_index(op.f("ix_jobs_workspace_finished_at"), "jobs", ["workspace", "finished_at"])
    op.create_index(op.f("ix_job_inputs_sha256"), "job_inputs", ["sha256"])


def downgrade() -> None:
    """Drop them."""
    op.drop_index(op.f("ix_job_inputs_sha256"), table_name="job_inputs")
    op.drop_index(op.f("ix_jobs_workspace_finished_at"), table_name="jobs")
    op.drop_column("jobs", "events_trimmed_at")
    for name in reversed(DAYS):
        op.drop_column("workspaces", name)
