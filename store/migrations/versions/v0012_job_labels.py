"""Names and labels of jobs, and the text they are searched by.

Safe while older APIs and workers run: every new column has a default of its own. Jobs of older servers are found by their
process, id and meshes once this has run; those they accept meanwhile by status, process and labels alone.
Going back forgets names and labels; jobs stay."""

import sqlalchemy as sa
from alembic import op

revision = "v0012"
down_revision: str | None = "v0011"
branch_labels: str | None = None
depends_on: str | None = None

OLD = ["workspace", "created_at", "id"]
NEW = [*OLD, "search_text"]
MESHES = "SELECT {gather}(name, ' ') FROM job_inputs WHERE job_inputs.job_id = jobs.id"
FILL = "UPDATE jobs SET search_text = substr(lower(id || ' ' || process || ' ' || coalesce(({meshes}), '')), 1, 500)"


def upgrade() -> None:
    """The index of the list gets the text, so that a search reads nothing else."""
    op.add_column("jobs", sa.Column("name", sa.Text(), nullable=True))
    op.add_column("jobs", sa.Column("labels", sa.JSON(), nullable=True))
    op.add_column("jobs", sa.Column("search_text", sa.String(length=500), server_default=sa.text("''"), nullable=False))
    gather = "group_concat" if op.get_bind().dialect.name == "sqlite" else "string_agg"
    op.execute(sa.text(FILL.format(meshes=MESHES.format(gather=gather))))
    op.drop_index(op.f("ix_jobs_workspace_created_at_id"), table_name="jobs")
    op.create_index(op.f("ix_jobs_workspace_created_at_id_search_text"), "jobs", NEW)
    op.create_table(
        "job_labels",
        sa.Column("job_id", sa.String(length=36), nullable=False),
        sa.Column("label", sa.String(length=64), nullable=False),
        sa.Column("workspace", sa.String(length=63), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["job_id"], ["jobs.id"], name=op.f("fk_job_labels_job_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("job_id", "label", name=op.f("pk_job_labels")),
    )
    op.create_index(
        op.f("ix_job_labels_workspace_label_created_at_job_id"), "job_labels", ["workspace", "label", "created_at", "job_id"]
    )


def downgrade() -> None:
    """Drop them."""
    op.drop_table("job_labels")
    op.drop_index(op.f("ix_jobs_workspace_created_at_id_search_text"), table_name="jobs")
    op.create_index(op.f("ix_jobs_workspace_created_at_id"), "jobs", OLD)
    op.drop_column("jobs", "search_text")
    op.drop_column("jobs", "labels")
    op.drop_column("jobs", "name")
