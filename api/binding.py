"""Where the API may listen: loopback, or anywhere once it asks for keys."""

from __future__ import annotations

import ipaddress
import socket

from core.errors import InputError
from store.api_keys import ApiKeys
from store.database import Database
from store.settings import Settings


def require_allowed_binding(settings: Settings) -> None:
    """Raises InputError `server.host_not_loopback` or `server.host_unknown`."""
    if is_loopback(settings.host) or settings.require_keys == "true" or _has_keys(settings):
        return
    raise InputError(
        "server.host_not_loopback",
        f"Refusing to listen on {settings.host}: there are no API keys, so whoever reaches the port could use the server; "
        "make one first with `integument admin keys create`, or listen on 127.0.0.1",
        host=settings.host,
    )


def is_loopback(host: str) -> bool:
    """True if nobody but this machine reaches any address of `host`. Raises InputError `server.host_unknown`."""
    try:
        found = {str(info[4][0]) for info in socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)}
    except OSError as error:
        raise InputError("server.host_unknown", f"The host {host!r} has no address: {error}", host=host) from error
    return all(ipaddress.ip_address(address).is_loopback for address in found)


def _has_keys(settings: Settings) -> bool:
    """A database that is not there is not made."""
    if settings.sqlite_path is not None and not settings.sqlite_path.exists():
        return False
    database = Database(settings)
    try:
        return ApiKeys(database).any(before_migration=True)
    finally:
        database.close()
