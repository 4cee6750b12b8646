"""`integument admin workspaces`."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from pydantic import ByteSize, TypeAdapter

from core.errors import InputError
from server.admin.arguments import Subparsers, whole_number
from server.admin.desk import Desk, moment
from store.callback_secret import workspace_secret
from store.workspace import Workspace
from store.workspaces import Workspaces

COLUMNS = ("id", "bytes", "quota_bytes", "jobs", "quota_jobs", "created")
_SIZE = TypeAdapter(ByteSize)


def register(groups: Subparsers) -> None:
    """Add the commands."""
    commands = groups.add_parser("workspaces", help="who shares meshes and jobs").add_subparsers(metavar="COMMAND", required=True)
    create = commands.add_parser("create", help="make one; it cannot be removed")
    create.add_argument("name", metavar="NAME", help="small letters, digits and hyphens")
    create.add_argument("--quota-bytes", type=_size, default=None, help="may store so much (`50GiB`); 0 no limit")
    create.add_argument(
        "--quota-jobs", type=whole_number, default=None, help="may have so many jobs waiting and running; 0 no limit"
    )
    create.set_defaults(run=_create)
    commands.add_parser("list", help="list them").set_defaults(run=_list)
    secret = commands.add_parser("callback-secret", help="show what its receivers verify callbacks with")
    secret.add_argument("name", metavar="NAME")
    secret.set_defaults(run=_show_secret)


def _create(desk: Desk, options: Namespace) -> None:
    made = Workspaces(desk.db).create(options.name, quota_bytes=options.quota_bytes, quota_jobs=options.quota_jobs)
    desk.note_act("workspaces create", made.id, made.id)
    desk.show(_describe(desk, made))


def _list(desk: Desk, _options: Namespace) -> None:
    desk.show_table(COLUMNS, [_describe(desk, workspace) for workspace in Workspaces(desk.db).list()])


def _show_secret(desk: Desk, options: Namespace) -> None:
    workspace = Workspaces(desk.db).get(options.name).id
    if not desk.settings.callback_secret:
        raise InputError("callback.not_offered", "no callbacks are sent without INTEGUMENT_CALLBACK_SECRET")
    desk.note_act("workspaces callback-secret", workspace, workspace)
    secrets = [workspace_secret(secret, workspace) for secret in desk.settings.callback_secret]
    desk.show({"workspace": workspace, "secrets": secrets if desk.as_json else " ".join(secrets)})


def _size(text: str) -> int:
    return int(_SIZE.validate_python(text))


def _describe(desk: Desk, workspace: Workspace) -> dict[str, Any]:
    usage = desk.quotas.usage(workspace.id)
    return {
        "id": workspace.id,
        "bytes": usage.bytes,
        "jobs": usage.jobs,
        "quota_bytes": workspace.quota_bytes,
        "quota_jobs": workspace.quota_jobs,
        "created": moment(workspace.created_at),
    }
