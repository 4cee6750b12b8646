"""`integument admin doctor`."""

from __future__ import annotations

from argparse import Namespace

from server.admin.arguments import Subparsers
from server.admin.desk import Desk
from store.open_blobs import open_blobs

COLUMNS = ("part", "health", "said", "advice")


def register(groups: Subparsers) -> None:
    """Add the command."""
    doctor = groups.add_parser("doctor", help="look at everything the service needs; exit code 1 if something is wrong")
    doctor.add_argument("--deep", action="store_true", help="read and prove every file rows name")
    doctor.set_defaults(run=_examine)


def _examine(desk: Desk, options: Namespace) -> int:
    # loads API and worker, which other commands need not wait for
    from server.doctor.diagnosis import is_wrong
    from server.doctor.examine import examine
    from server.doctor.patient import Patient

    found = examine(Patient(desk.settings, desk.db, open_blobs(desk.settings, desk.db), options.deep))
    desk.show_table(
        COLUMNS, [{"part": one.part, "health": one.health.value, "said": one.said, "advice": one.advice} for one in found]
    )
    return 1 if is_wrong(found) else 0
