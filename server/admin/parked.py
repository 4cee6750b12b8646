"""`integument admin parked`: requests that are refused because they took down their workers."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from server.admin.arguments import Subparsers
from server.admin.desk import Desk, moment
from store.parked import Parked, ParkedRequest
from store.workspace import WorkspaceId

COLUMNS = ("job", "workspace", "process", "code", "attempts", "parked")


def register(groups: Subparsers) -> None:
    """Add the commands."""
    commands = groups.add_parser("parked", help="requests that took down their workers").add_subparsers(
        metavar="COMMAND", required=True
    )
    listing = commands.add_parser("list", help="list them, the newest first")
    listing.add_argument("--workspace", default=None, help="of this one only")
    listing.set_defaults(run=_list)
    show = commands.add_parser("show", help="the evidence against one")
    show.add_argument("id", metavar="JOB", help="the job that was parked, or one that asks for the same")
    show.set_defaults(run=_show)
    release = commands.add_parser("release", help="let it be sent again, once you know why it crashed")
    release.add_argument("id", metavar="JOB", help="as for show")
    release.set_defaults(run=_release)


def _list(desk: Desk, options: Namespace) -> None:
    workspace = None if options.workspace is None else WorkspaceId(options.workspace)
    desk.show_table(COLUMNS, [_line(request) for request in Parked(desk.db).list(workspace)])


def _show(desk: Desk, options: Namespace) -> None:
    request = Parked(desk.db).get(options.id)
    if desk.as_json:
        desk.show({**_line(request), "evidence": [dict(attempt) for attempt in request.evidence]})
        return
    desk.show(_line(request))
    for attempt in request.evidence:
        print()
        desk.show({name: value for name, value in attempt.items() if name != "log"})
        print(attempt["log"].rstrip())


def _release(desk: Desk, options: Namespace) -> None:
    request = Parked(desk.db).release(options.id)
    desk.note_act("parked release", request.job_id, request.workspace)
    desk.show(_line(request))


def _line(request: ParkedRequest) -> dict[str, Any]:
    return {
        "job": request.job_id,
        "workspace": request.workspace,
        "process": request.process,
        "code": request.code,
        "attempts": len(request.evidence),
        "parked": moment(request.parked_at),
    }
