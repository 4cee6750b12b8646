"""How many connections there are, in all and from one address: each costs memory and a descriptor before a key is seen."""

from __future__ import annotations

import ipaddress
from collections import Counter
from dataclasses import dataclass, field

IPV6_NETWORK = 64  # bits of one customer's network: its addresses count as one


@dataclass(slots=True)
class Crowd:
    """Of one process; used by its event loop alone. 0: no limit."""

    most: int
    most_of_one: int
    _here: Counter[str] = field(default_factory=Counter)

    def enter(self, address: str) -> bool:
        """One connection more; whether there is room. One that is refused leaves, too."""
        name = _name(address)
        self._here[name] += 1
        too_many = 0 < self.most < self._here.total()
        return not too_many and not 0 < self.most_of_one < self._here[name]

    def leave(self, address: str) -> None:
        """One less."""
        name = _name(address)
        self._here[name] -= 1
        if not self._here[name]:
            del self._here[name]


def _name(address: str) -> str:
    try:
        found = ipaddress.ip_address(address)
    except ValueError:  # a unix socket has none
        return address
    if isinstance(found, ipaddress.IPv4Address):
        return address
    return str(found.ipv4_mapped or ipaddress.ip_network((found, IPV6_NETWORK), strict=False))
