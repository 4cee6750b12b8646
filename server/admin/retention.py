"""`integument admin retention`: how long what is done is kept."""

from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from dataclasses import replace
from typing import Any

from core.errors import InputError
from server.admin.arguments import LONGEST_DAYS, Subparsers
from server.admin.confirmation import add_yes, require_yes
from server.admin.desk import Desk
from store.retention import Expired, Retention
from store.retention_policy import RetentionPolicies, RetentionPolicy
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId

COLUMNS = ("workspace", "jobs_days", "meshes_days", "events_days", "own")
RUN_COLUMNS = ("workspace", "jobs", "meshes", "events_of")
KINDS = ("jobs", "meshes", "events")
AS_SERVER = "server"
RUN_S = 3600.0


def register(groups: Subparsers) -> None:
    """Add the commands."""
    commands = groups.add_parser("retention", help="how long jobs, uploads and events are kept").add_subparsers(
        metavar="COMMAND", required=True
    )
    commands.add_parser("show", help="the days of every workspace; 0 keeps for ever").set_defaults(run=_show)

    change = commands.add_parser("set", help="change those of a workspace")
    change.add_argument("--workspace", default=DEFAULT_WORKSPACE, help="whose [%(default)s]")
    for kind in KINDS:
        change.add_argument(
            f"--{kind}-days", type=_days, default=None, metavar="DAYS", help="0 for ever, `server`: as the settings"
        )
    change.set_defaults(run=_set)

    run = commands.add_parser("run", help="remove now what the service removes by and by")
    run.add_argument("--dry-run", action="store_true", help="only count it")
    add_yes(run)
    run.set_defaults(run=_run)


def _show(desk: Desk, _options: Namespace) -> None:
    policies = _policies(desk)
    desk.show_table(COLUMNS, [_line(policies, workspace, policy) for workspace, policy in policies.all().items()])


def _set(desk: Desk, options: Namespace) -> None:
    policies, workspace = _policies(desk), WorkspaceId(options.workspace)
    given = {f"{kind}_days": days for kind in KINDS if (days := getattr(options, f"{kind}_days")) is not None}
    if not given:
        raise InputError("admin.nothing_selected", "say --jobs-days, --meshes-days or --events-days")
    own = replace(policies.own(workspace), **{name: None if days == AS_SERVER else days for name, days in given.items()})
    policy = policies.set(workspace, own)
    desk.note_act("retention set", ", ".join(f"{name} {days}" for name, days in given.items()), workspace)
    desk.show(_line(policies, workspace, policy))


def _run(desk: Desk, options: Namespace) -> None:
    retention = Retention(desk.db, _policies(desk))
    found = retention.count()
    if not options.dry_run:
        total = sum(found.values(), Expired())
        if not total.is_nothing:
            require_yes(options, f"remove {total.jobs} jobs, {total.meshes} meshes and the events of {total.events_of} jobs")
        swept = retention.sweep(RUN_S)
        desk.note_act("retention run", f"{swept.jobs} jobs, {swept.meshes} meshes", DEFAULT_WORKSPACE)
    desk.show_table(
        RUN_COLUMNS,
        [
            {"workspace": name, "jobs": expired.jobs, "meshes": expired.meshes, "events_of": expired.events_of}
            for name, expired in found.items()
        ],
    )


def _policies(desk: Desk) -> RetentionPolicies:
    return RetentionPolicies(desk.db, RetentionPolicy.of(desk.settings))


def _line(policies: RetentionPolicies, workspace: WorkspaceId, policy: RetentionPolicy) -> dict[str, Any]:
    own = policies.own(workspace)
    return {
        "workspace": workspace,
        "jobs_days": policy.jobs_days,
        "meshes_days": policy.meshes_days,
        "events_days": policy.events_days,
        "own": [kind for kind in KINDS if getattr(own, f"{kind}_days") is not None],
    }


def _days(text: str) -> float | str:
    if text == AS_SERVER:
        return text
    days = float(text)
    if not 0 <= days <= LONGEST_DAYS:
        raise ArgumentTypeError(f"{text} is not between 0 and {LONGEST_DAYS}")
    return days
