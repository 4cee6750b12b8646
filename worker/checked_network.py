"""Connections to checked addresses only: a name is looked up once, and what was checked is what is connected to."""

from __future__ import annotations

import socket
import ssl
import time
from collections.abc import Callable, Iterable, Sequence
from ipaddress import ip_address
from typing import Any

import httpcore

from store.forbidden_addresses import Address
from store.receivers import Receivers

Resolve = Callable[[str, int], Sequence[Address]]


def resolve(host: str, port: int) -> tuple[Address, ...]:
    """All addresses of a name, each once, in the resolver's order. Raises httpcore.ConnectError."""
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        raise httpcore.ConnectError("its name cannot be looked up") from None
    # a scope behind % says which wire a link-local address is on; such addresses are refused anyway
    return tuple(dict.fromkeys(ip_address(str(told[4][0]).partition("%")[0]) for told in found))


class CheckedNetwork(httpcore.NetworkBackend):
    """For one request, which ends `limit_s` after it began, however little is sent at a time.

    Host and SNI stay as the URL has them: httpcore takes both from there, not from the connection."""

    def __init__(self, receivers: Receivers, limit_s: float, resolve: Resolve = resolve) -> None:
        self._receivers = receivers
        self._resolve = resolve
        self._deadline = time.monotonic() + limit_s
        self._backend = httpcore.SyncBackend()

    def connect_tcp(
        self,
        host: str,
        port: int,
        timeout: float | None = None,
        local_address: str | None = None,
        socket_options: Iterable[Any] | None = None,
    ) -> httpcore.NetworkStream:
        """To the first address that answers, after all of them were checked.

        Raises InputError `callback.host_refused`, httpcore.ConnectError, httpcore.ConnectTimeout."""
        addresses = self._resolve(host, port)
        for address in addresses:
            self._receivers.require_address(host, address)
        failure: Exception = httpcore.ConnectError("its name has no address")
        for position, address in enumerate(addresses):
            share_s = self._left() / (len(addresses) - position)  # one that swallows packets leaves time for the others
            try:
                stream = self._backend.connect_tcp(str(address), port, share_s, local_address, socket_options)
            except (httpcore.ConnectError, httpcore.ConnectTimeout) as error:
                failure = error
            else:
                return _TimedStream(stream, self._left)
        raise failure

    def _left(self) -> float:
        left_s = self._deadline - time.monotonic()
        if left_s <= 0:
            raise httpcore.ReadTimeout("it took too long")
        return left_s


class _TimedStream(httpcore.NetworkStream):
    """Every wait ends with the request's deadline."""

    def __init__(self, stream: httpcore.NetworkStream, left: Callable[[], float]) -> None:
        self._stream = stream
        self._left = left

    def read(self, max_bytes: int, timeout: float | None = None) -> bytes:
        return self._stream.read(max_bytes, self._left())

    def write(self, buffer: bytes, timeout: float | None = None) -> None:
        self._stream.write(buffer, self._left())

    def close(self) -> None:
        self._stream.close()

    def start_tls(
        self, ssl_context: ssl.SSLContext, server_hostname: str | None = None, timeout: float | None = None
    ) -> httpcore.NetworkStream:
        return _TimedStream(self._stream.start_tls(ssl_context, server_hostname, self._left()), self._left)

    def get_extra_info(self, info: str) -> Any:
        return self._stream.get_extra_info(info)
