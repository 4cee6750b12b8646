"""`integument admin keys`."""

from __future__ import annotations

from argparse import Namespace
from datetime import UTC, datetime, timedelta
from typing import Any

from server.admin.arguments import Subparsers, positive_days
from server.admin.desk import Desk, moment
from store.api_key import ApiKey, IssuedKey
from store.api_keys import ApiKeys
from store.scope import Scope
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

COLUMNS = ("id", "workspace", "name", "scopes", "state", "expires", "last_used", "replaced_by")
USUAL_SCOPES = (Scope.READ, Scope.SUBMIT)


def register(groups: Subparsers) -> None:
    """Add the commands."""
    commands = groups.add_parser("keys", help="API keys").add_subparsers(metavar="COMMAND", required=True)

    create = commands.add_parser("create", help="make a key and print it, this once")
    create.add_argument("--workspace", default=DEFAULT_WORKSPACE, help="whose meshes and jobs it opens [%(default)s]")
    create.add_argument("--name", default="", help="who uses it, for lists and the audit log")
    create.add_argument(
        "--scope", action="append", choices=list(Scope), help="what it allows; repeat; without one read and submit"
    )
    create.add_argument("--days", type=positive_days, default=None, help="expires after so many days; without it never")
    create.set_defaults(run=_create)

    listing = commands.add_parser("list", help="list keys, the newest first")
    listing.add_argument("--workspace", default=None, help="of this one only")
    listing.set_defaults(run=_list)

    rotate = commands.add_parser("rotate", help="make a successor; the old key is good for a while longer")
    rotate.add_argument("id", metavar="ID", help="the part behind itg_")
    rotate.add_argument("--overlap-days", type=positive_days, default=timedelta(days=7), help="both are good for so long [7]")
    rotate.set_defaults(run=_rotate)

    revoke = commands.add_parser("revoke", help="end a key at once")
    revoke.add_argument("id", metavar="ID", help="the part behind itg_")
    revoke.set_defaults(run=_revoke)


def _create(desk: Desk, options: Namespace) -> None:
    scopes = [Scope(name) for name in options.scope or USUAL_SCOPES]
    keys = ApiKeys(desk.db)
    is_first = not keys.any()
    issued = keys.create(WorkspaceId(options.workspace), options.name, scopes, options.days)
    desk.note_act("keys create", issued.key.id, issued.key.workspace)
    _show_issued(desk, issued)
    if is_first:
        desk.note("It is the first one: from now on every request needs a key, on loopback too.")


def _list(desk: Desk, options: Namespace) -> None:
    workspace = None if options.workspace is None else WorkspaceId(options.workspace)
    desk.show_table(COLUMNS, [_describe(key) for key in ApiKeys(desk.db).list(workspace)])


def _rotate(desk: Desk, options: Namespace) -> None:
    issued = ApiKeys(desk.db).rotate(options.id, options.overlap_days)
    desk.note_act("keys rotate", f"{options.id} to {issued.key.id}", issued.key.workspace)
    _show_issued(desk, issued)


def _revoke(desk: Desk, options: Namespace) -> None:
    revoked = ApiKeys(desk.db).revoke(options.id)
    desk.note_act("keys revoke", revoked.id, revoked.workspace)
    desk.show(_describe(revoked))


def _show_issued(desk: Desk, issued: IssuedKey) -> None:
    desk.show({"key": issued.text, **_describe(issued.key)})
    desk.note("The key is shown this once; only its SHA-256 is kept.")


def _describe(key: ApiKey) -> dict[str, Any]:
    return {
        "id": key.id,
        "workspace": key.workspace,
        "name": key.name,
        "scopes": sorted(key.scopes),
        "state": key.state_at(datetime.now(UTC)),
        "created": moment(key.created_at),
        "expires": moment(key.expires_at),
        "last_used": moment(key.last_used_at),
        "revoked": moment(key.revoked_at),
        "replaced_by": key.replaced_by,
    }
