"""Where the API may listen: loopback, unless the settings say that more is meant."""

from __future__ import annotations

import ipaddress
import socket

from core.errors import InputError
from store.settings import Settings


def require_allowed_binding(settings: Settings) -> None:
    """Raises InputError `server.host_not_loopback` or `server.host_unknown`."""
    if settings.allow_remote:
        return
    try:
        found = {str(info[4][0]) for info in socket.getaddrinfo(settings.host, None, type=socket.SOCK_STREAM)}
    except OSError as error:
        raise InputError(
            "server.host_unknown", f"The host {settings.host!r} has no address: {error}", host=settings.host
        ) from error
    if not all(ipaddress.ip_address(address).is_loopback for address in found):
        raise InputError(
            "server.host_not_loopback",
            f"Refusing to listen on {settings.host}: there are no keys yet, so whoever reaches the port may use the server; "
            "listen on 127.0.0.1, or set INTEGUMENT_ALLOW_REMOTE=true on a network you trust",
            host=settings.host,
        )
