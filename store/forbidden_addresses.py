"""Addresses no callback goes to: whatever is not the public internet, however it is written."""

from __future__ import annotations

from collections.abc import Iterator
from ipaddress import IPv4Address, IPv6Address, ip_network

Address = IPv4Address | IPv6Address

# An explicit list: `is_global` lets multicast, 192.0.0.8 and addresses within addresses pass.
# IANA's special-purpose registries (RFC 6890 and its updates).
FORBIDDEN = tuple(
    ip_network(text)
    for text in (
        "0.0.0.0/8",  # this network; 0.0.0.0 reaches loopback
        "10.0.0.0/8",
        "100.64.0.0/10",  # shared by carriers
        "127.0.0.0/8",
        "169.254.0.0/16",  # link-local, and where clouds keep their metadata
        "172.16.0.0/12",
        "192.0.0.0/24",
        "192.0.2.0/24",  # documentation
        "192.31.196.0/24",
        "192.52.193.0/24",
        "192.88.99.0/24",  # relays of 6to4
        "192.168.0.0/16",
        "192.175.48.0/24",
        "198.18.0.0/15",  # benchmarks
        "198.51.100.0/24",
        "203.0.113.0/24",
        "224.0.0.0/4",  # multicast
        "240.0.0.0/4",  # reserved, and broadcast
        "::/96",  # unspecified, loopback, IPv4-compatible
        "::ffff:0:0:0/96",  # IPv4-translated (SIIT)
        "64:ff9b:1::/48",  # NAT64 of a site: where its prefix ends we cannot know
        "100::/64",  # discarded
        "100:0:0:1::/64",
        "2001::/23",  # protocol assignments, Teredo and ORCHID among them
        "2001:db8::/32",
        "2620:4f:8000::/48",
        "3fff::/20",  # documentation
        "5f00::/16",  # segment routing
        "fc00::/7",  # unique local
        "fe80::/10",  # link-local
        "fec0::/10",  # site-local, of old
        "ff00::/8",  # multicast
    )
)
NAT64 = ip_network("64:ff9b::/96")
SIX_TO_FOUR = ip_network("2002::/16")


def is_forbidden(address: Address) -> bool:
    """True if the address, or one packed into it, is in FORBIDDEN."""
    return any(form in network for form in forms_of(address) for network in FORBIDDEN if network.version == form.version)


def forms_of(address: Address) -> Iterator[Address]:
    """The address, and the IPv4 one a gateway or the kernel would make of it (v4-mapped, NAT64, 6to4).

    A v4-mapped address is another way to write the IPv4 one, so only that counts."""
    if isinstance(address, IPv6Address):
        if address.ipv4_mapped is not None:
            yield address.ipv4_mapped
            return
        if address in NAT64:
            yield IPv4Address(int(address) & 0xFFFF_FFFF)
        elif address in SIX_TO_FOUR:
            yield IPv4Address(int(address) >> 80 & 0xFFFF_FFFF)
    yield address
