"""Where the API listens. Which hosts it may listen on is its own decision: api.binding."""

from __future__ import annotations

import socket

from core.errors import StateError


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
    """The URL of the API for clients on this machine."""
    host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)  # noqa: S104 - nothing is bound here
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"
