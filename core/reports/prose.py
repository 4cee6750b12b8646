"""Sentences of a report as people read them: what was decided, and why in a few words."""

from __future__ import annotations

import re
from collections.abc import Collection

from core.errors import Fault
from core.reports.wording import whole
from core.schema.report import FailureReport

# an integer of five digits or more, or one with commas; not in a name, code, decimal number or quotation
_QUOTED = r"'[^'\n]*'|\"[^\"\n]*\""
_LARGE = r"(?<![\w.,:/=+#-])(?:\d{1,3}(?:,\d{3})+|\d{5,})(?![\w,:/=-]|\.\d)"
_LARGE_OR_QUOTED = re.compile(f"(?P<quoted>{_QUOTED})|(?P<large>{_LARGE})")
_CLAUSE_ENDS = re.compile(r"; |: |\. | \(|, so |, or ")
_STANDS_ALONE = ("; ", ": ", ". ")  # what follows one of these
SHORTEST_CLAUSE, LONGEST_CLAUSE = 16, 110

_VERDICTS = {"fields": ("Every triangle has a value", "Triangles without a value")}  # of processes that make no surfaces
_FAULTS: dict[Fault, str] = {
    "input": "Refused",
    "limit": "Stopped at a limit of this server",
    "state": "Refused",
    "internal": "Failed by a fault of the server",
}


def verdict_words(process: str, ready: bool, failure: FailureReport | None = None) -> str:
    """The verdict as the first line of a report: `Simulation ready`, `Not ready`, `Refused`."""
    if failure is not None:
        return _FAULTS[failure.fault]
    good, bad = _VERDICTS.get(process, ("Simulation ready", "Not ready"))
    return good if ready else bad


def headline(message: str) -> tuple[str, str]:
    """(what a message says first, what is left to say): cut at the first colon, semicolon or bracket after a few words.

    Where what is left cannot stand alone, it is the whole message."""
    end = next((found for found in _CLAUSE_ENDS.finditer(message) if found.start() >= SHORTEST_CLAUSE), None)
    clause = (message if end is None else message[: end.start()]).rstrip(".")
    rest = "" if end is None else message[end.end() :] if end[0] in _STANDS_ALONE else message
    if len(clause) > LONGEST_CLAUSE:
        clause, rest = f"{clause[:LONGEST_CLAUSE].rsplit(' ', 1)[0]} …", message
    return grouped(clause.replace("`", "")), rest


def sentence(text: str, names: Collection[str] = ()) -> str:
    """As the first words of a page: with a capital unless a name begins it, without the marks of code."""
    plain = grouped(text.replace("`", ""))
    first = plain.split(" ", 1)[0]
    return plain if first in names or first.endswith(":") else plain[:1].upper() + plain[1:]


def grouped(text: str) -> str:
    """The text with its large whole numbers as tables have them: `107 024` for 107024 and for 107,024."""

    def shown(found: re.Match[str]) -> str:
        return found["quoted"] or whole(int(found["large"].replace(",", "")))

    return _LARGE_OR_QUOTED.sub(shown, text)
