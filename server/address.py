"""Where the API listens: loopback unless allowed otherwise, a port that is free."""

from __future__ import annotations

import ipaddress
import socket

from core.errors import InputError, StateError


def require_loopback(host: str) -> None:
    """Raises: InputError `server.host_not_loopback` unless every address of `host` is one of this machine alone."""
    try:
        addresses = {str(info[4][0]) for info in socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)}
    except OSError as error:
        raise InputError("server.host_unknown", f"The host {host!r} has no address: {error}.", host=host) from error
    if not all(ipaddress.ip_address(address).is_loopback for address in addresses):
        raise InputError(
            "server.host_not_loopback",
            f"Refusing to listen on {host}: this server has no keys, so whoever reaches the port may use it. "
            "Listen on 127.0.0.1, or allow it explicitly (INTEGUMENT_ALLOW_REMOTE=true) on a network you trust.",
            host=host,
        )


def choose_port(host: str, port: int) -> int:
    """`port`, or a free one for 0. Raises: StateError `server.port_in_use`."""
    family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # as the API does: an old connection is no obstacle
        try:
            probe.bind(address)
        except OSError as error:
            raise StateError(
                "server.port_in_use",
                f"Port {port} of {host} cannot be used: {error.strerror}. Choose another, or 0 for any free one.",
                port=port,
            ) from error
        return int(probe.getsockname()[1])


def base_url(host: str, port: int) -> str:
    """The URL of the API on this machine."""
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"
