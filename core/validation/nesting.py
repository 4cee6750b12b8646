"""Which mesh encloses which."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from core.schema.report import PairReport


def nest(names: Sequence[str], pairs: Iterable[PairReport]) -> dict[str, str | None]:
    """Name -> the mesh that encloses it most closely, or None.

    Meshes that do not intersect and enclose the same one enclose each other in turn, so of all enclosing meshes the
    closest is the one that most others enclose; where overlaps break that rule, the first named wins.
    """
    enclosing: dict[str, list[str]] = {name: [] for name in names}
    for pair in pairs:
        if pair.relation == "a_inside_b":
            enclosing[pair.a].append(pair.b)
        elif pair.relation == "b_inside_a":
            enclosing[pair.b].append(pair.a)
    return {
        name: max(holders, key=lambda holder: (len(enclosing[holder]), -names.index(holder))) if holders else None
        for name, holders in enclosing.items()
    }
