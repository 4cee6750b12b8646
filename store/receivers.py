"""Where callbacks may go: the public internet by https, and what the operator allows besides (docs/adr/0008)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from ipaddress import IPv4Network, IPv6Address, IPv6Network, ip_address, ip_network
from urllib.parse import SplitResult, urlsplit

from core.errors import InputError
from store.forbidden_addresses import Address, is_forbidden

MAX_URI = 2_000
PORTS = {"https": 443, "http": 80}
_VISIBLE = re.compile(r"[!-\[\]-~]+")  # ASCII without space and backslash, which parsers read as they like
_NAME = re.compile(r"(?=.{1,253}$)([a-z0-9_]([a-z0-9_-]{0,61}[a-z0-9_])?\.)*[a-z]([a-z0-9-]{0,61}[a-z0-9])?")
_LOCAL_NAMES = (".localhost", ".local", ".internal", ".home.arpa")


class Receivers:
    """What the setting `callback_allow` says; entries are host names, addresses and networks."""

    def __init__(self, allowed: Sequence[str]) -> None:
        """Raises ValueError for what is no name and no network."""
        self._names: set[str] = set()
        self._networks: list[IPv4Network | IPv6Network] = []
        for entry in allowed:
            if _NAME.fullmatch(entry):
                self._names.add(entry)
            else:
                try:
                    self._networks.append(ip_network(entry))
                except ValueError:
                    raise ValueError(f"{entry!r} is no host name, address or network") from None

    def require_uri(self, uri: str) -> None:
        """What can be said before any name is looked up.

        Raises InputError `callback.uri_invalid`, `callback.scheme_refused`, `callback.port_refused`, `callback.host_refused`."""
        parts, port = _split(uri)
        host = str(parts.hostname)
        literal = _literal(host)
        if host in self._names or (literal is not None and self._is_allowed(literal)):
            return
        if parts.scheme != "https":
            raise InputError(
                "callback.scheme_refused",
                f"callbacks go out by https; {parts.scheme} only to hosts the operator allows",
                host=host,
            )
        if port != PORTS["https"]:
            raise InputError(
                "callback.port_refused", f"callbacks go to port 443; port {port} only of hosts the operator allows", port=port
            )
        if is_forbidden(literal) if literal is not None else "." not in host or host.endswith(_LOCAL_NAMES):
            raise _refused(host)

    def require_address(self, host: str, address: Address) -> None:
        """After the name was looked up. Raises InputError `callback.host_refused`; it does not name the address: that is nobody's
        business."""
        if host not in self._names and not self._is_allowed(address) and is_forbidden(address):
            raise _refused(host)

    def _is_allowed(self, address: Address) -> bool:
        mapped = address.ipv4_mapped if isinstance(address, IPv6Address) else None
        forms = (address,) if mapped is None else (address, mapped)
        return any(form in network for form in forms for network in self._networks if network.version == form.version)


def host_of(uri: str) -> str:
    """For logs: the rest of a URI may be a secret."""
    return str(urlsplit(uri).hostname)


def _refused(host: str) -> InputError:
    return InputError(
        "callback.host_refused", f"{host} is not on the public internet, and the operator does not allow it besides", host=host
    )


def _split(uri: str) -> tuple[SplitResult, int]:
    """Parts and port. Raises InputError `callback.uri_invalid`."""
    reason = ""
    if len(uri) > MAX_URI:
        reason = f"it has {len(uri)} characters, {MAX_URI} are allowed"
    elif not _VISIBLE.fullmatch(uri):
        reason = "it has characters other than visible ASCII"
    else:
        try:
            parts = urlsplit(uri)
            port = parts.port
            if parts.scheme not in PORTS:
                reason = "it does not begin with https:// or http://"
            elif "@" in parts.netloc:
                reason = "it has a user name or password"
            elif "#" in uri:
                reason = "it has a fragment"
            elif port == 0 or not _is_host(parts.hostname or ""):
                reason = "it has no valid host and port"
            else:
                return parts, port or PORTS[parts.scheme]
        except ValueError:
            reason = "it cannot be read"
    raise InputError("callback.uri_invalid", f"a URI of the subscriber is refused: {reason}")


def _is_host(host: str) -> bool:
    """A name whose last label begins with a letter, or an address in full: 127.1 and 0x7f000001 are neither."""
    return _NAME.fullmatch(host) is not None or _literal(host) is not None


def _literal(host: str) -> Address | None:
    try:
        return ip_address(host) if "%" not in host else None
    except ValueError:
        return None
