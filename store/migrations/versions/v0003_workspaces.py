"""Workspaces: what was there before belongs to `default`. Sums of outputs, for quotas.

Going back keeps meshes and jobs, but not whose they are: the older server shows everything to everybody."""

import sqlalchemy as sa
from alembic import op

revision = "v0003"
down_revision: str | None = "v0002"
branch_labels: str | None = None
depends_on: str | None = None

DEFAULT = "default"
NAME = sa.String(length=63)


def _job_checks() -> tuple[sa.CheckConstraint, ...]:
    """SQLite's tables are made anew, and what is copied of them is without their checks."""
    if op.get_bind().dialect.name != "sqlite":
        return ()
    statuses = "status IN ('accepted', 'running', 'successful', 'failed', 'dismissed')"
    return (
        sa.CheckConstraint("(status = 'running') = (lease_until IS NOT NULL)", name=op.f("ck_jobs_running_has_lease")),
        sa.CheckConstraint(statuses, name=op.f("ck_jobs_status_known")),
    )


def upgrade() -> None:
    """Make `workspaces`; give meshes, jobs and idempotency keys an owner."""
    workspaces = op.create_table(
        "workspaces",
        sa.Column("id", NAME, nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("quota_bytes", sa.BigInteger(), nullable=True),
        sa.Column("quota_jobs", sa.Integer(), nullable=True),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_workspaces")),
    )
    op.execute(workspaces.insert().values(id=DEFAULT, created_at=sa.func.current_timestamp()))
    for table in ("meshes", "jobs"):
        op.add_column(table, sa.Column("workspace", NAME, nullable=True))
    op.add_column("jobs", sa.Column("output_bytes", sa.BigInteger(), nullable=True))
    op.execute("UPDATE meshes SET workspace = 'default'")
    op.execute(
        "UPDATE jobs SET workspace = 'default', "
        "output_bytes = (SELECT COALESCE(SUM(size), 0) FROM job_outputs WHERE job_outputs.job_id = jobs.id)"
    )
    with op.batch_alter_table("meshes") as meshes:
        meshes.alter_column("workspace", existing_type=NAME, nullable=False)
        meshes.create_foreign_key(op.f("fk_meshes_workspace"), "workspaces", ["workspace"], ["id"])
        meshes.drop_index(op.f("ix_meshes_created_at_id"))
        meshes.create_index(op.f("ix_meshes_workspace_created_at_id"), ["workspace", "created_at", "id"])
        meshes.create_index(op.f("ix_meshes_workspace_size_bytes"), ["workspace", "size_bytes"])
    with op.batch_alter_table("jobs", table_args=_job_checks()) as jobs:
        jobs.alter_column("workspace", existing_type=NAME, nullable=False)
        jobs.alter_column("output_bytes", existing_type=sa.BigInteger(), nullable=False)
        jobs.create_foreign_key(op.f("fk_jobs_workspace"), "workspaces", ["workspace"], ["id"])
        jobs.drop_index(op.f("ix_jobs_created_at_id"))
        jobs.create_index(op.f("ix_jobs_workspace_created_at_id"), ["workspace", "created_at", "id"])
        jobs.create_index(op.f("ix_jobs_workspace_status"), ["workspace", "status"])
        jobs.create_index(op.f("ix_jobs_workspace_output_bytes"), ["workspace", "output_bytes"])
    op.add_column("idempotency_keys", sa.Column("workspace", NAME, nullable=True))
    op.execute("UPDATE idempotency_keys SET workspace = 'default'")
    with op.batch_alter_table("idempotency_keys") as keys:
        keys.alter_column("workspace", existing_type=NAME, nullable=False)
        keys.drop_constraint(op.f("pk_idempotency_keys"), type_="primary")
        keys.create_primary_key(op.f("pk_idempotency_keys"), ["workspace", "key"])
        keys.create_foreign_key(op.f("fk_idempotency_keys_workspace"), "workspaces", ["workspace"], ["id"])


def downgrade() -> None:
    """Forget whose everything is."""
    op.execute("DELETE FROM idempotency_keys WHERE workspace <> 'default'")
    with op.batch_alter_table("idempotency_keys") as keys:
        keys.drop_constraint(op.f("fk_idempotency_keys_workspace"), type_="foreignkey")
        keys.drop_constraint(op.f("pk_idempotency_keys"), type_="primary")
        keys.create_primary_key(op.f("pk_idempotency_keys"), ["key"])
        keys.drop_column("workspace")
    with op.batch_alter_table("jobs", table_args=_job_checks()) as jobs:
        jobs.drop_index(op.f("ix_jobs_workspace_output_bytes"))
        jobs.drop_index(op.f("ix_jobs_workspace_status"))
        jobs.drop_index(op.f("ix_jobs_workspace_created_at_id"))
        jobs.create_index(op.f("ix_jobs_created_at_id"), ["created_at", "id"])
        jobs.drop_constraint(op.f("fk_jobs_workspace"), type_="foreignkey")
        jobs.drop_column("output_bytes")
        jobs.drop_column("workspace")
    with op.batch_alter_table("meshes") as meshes:
        meshes.drop_index(op.f("ix_meshes_workspace_size_bytes"))
        meshes.drop_index(op.f("ix_meshes_workspace_created_at_id"))
        meshes.create_index(op.f("ix_meshes_created_at_id"), ["created_at", "id"])
        meshes.drop_constraint(op.f("fk_meshes_workspace"), type_="foreignkey")
        meshes.drop_column("workspace")
    op.drop_table("workspaces")
