"""What the server needs to do its work. Each check returns None, or says what is missing."""

from __future__ import annotations

from collections.abc import Callable

from api.outlook import describe_unserved
from api.request_folder import request_folder
from api.services import Services


def _check_database(services: Services) -> str | None:
    return None if services.db.is_migrated() else "the tables are not those of this version; run the migration"


def _check_broker(services: Services) -> str | None:
    return None if services.doorbell.is_answered() else "the broker does not answer"


def _check_blobs(services: Services) -> str | None:
    """Writes where uploads go, and where they are kept."""
    with request_folder(services.incoming_dir) as folder:
        (folder / "probe").write_bytes(b"ready")
    services.blobs.check()
    return None


def _check_disk(services: Services) -> str | None:
    free, floor = services.disk.free_bytes(), services.disk.floor_bytes
    return None if free >= floor else f"{free} bytes are free, {floor} are needed"


def _check_drain(services: Services) -> str | None:
    return "the server is stopping" if services.drain.begun else None


def _check_workers(services: Services) -> str | None:
    served = services.workers.served_queues()
    if not served:
        return "no worker has given word lately; jobs are accepted, and wait"
    oldest_s = services.backlog.oldest_waiting_s()
    unserved = [f"{describe_unserved(queue, served)}, and some wait" for queue in oldest_s if queue not in served]
    return "; ".join(unserved) or None


CHECKS: dict[str, Callable[[Services], str | None]] = {
    "database": _check_database,
    "broker": _check_broker,
    "blobs": _check_blobs,
    "disk": _check_disk,
    "drain": _check_drain,
    "workers": _check_workers,
}
