"""What this host can do to lock children in, asked before there are any."""

from __future__ import annotations

import logging

from core.errors import InternalError
from sandbox.call_filter import can_filter_calls
from sandbox.landlock import SCOPES_SINCE, landlock_version

logger = logging.getLogger(__name__)

NO_LANDLOCK = "this kernel has no Landlock (Linux 5.13, switched on): a child reads what the server can read"
NO_FILTER = "no filter of system calls is known for this machine: a child may start programs and open sockets"
OLD_LANDLOCK = (
    "this kernel's Landlock is older than Linux 6.12: that no child signals others is held by the filter of system calls alone"
)


def missing_confinement() -> list[str]:
    """What is missing, in words; empty where children are locked in as SECURITY.md says."""
    return [
        *([NO_LANDLOCK] if landlock_version() == 0 else []),
        *([NO_FILTER] if not can_filter_calls() else []),
    ]


def survey_confinement(*, required: bool) -> None:
    """Tell the log; raises InternalError `confinement.missing` if something is missing and `required`."""
    missing = missing_confinement()
    if missing and required:
        raise not_confined(missing)
    for lack in missing:
        logger.warning("not confined: %s", lack)
    if not missing:
        version = landlock_version()
        logger.info("children are confined by Landlock (version %d) and a filter of system calls", version)
        if version < SCOPES_SINCE:
            logger.info("%s", OLD_LANDLOCK)


def not_confined(missing: list[str]) -> InternalError:
    """The error for a host that cannot lock children in although it was told to."""
    return InternalError(
        "confinement.missing", f"Refusing to work unconfined (INTEGUMENT_REQUIRE_CONFINEMENT is set): {'; '.join(missing)}"
    )
