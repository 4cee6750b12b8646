"""Names found in files, made safe to show and to tell apart."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST_NAME = 64


def clean_name(raw: bytes | str, fallback: str = "") -> str:
    """Printable text of at most 64 characters with single spaces; `fallback` if nothing is left."""
    text = raw.decode("utf-8", errors="replace") if isinstance(raw, bytes) else raw
    printable = "".join(letter if letter.isprintable() else " " for letter in text)
    return " ".join(printable.split())[:LONGEST_NAME].strip() or fallback


def stem_of(file_name: str, endings: Iterable[str]) -> str:
    """A file's name without the longest of the endings, and as it is without any of them."""
    for ending in sorted(endings, key=len, reverse=True):
        if file_name.lower().endswith(ending):
            return file_name[: -len(ending)]
    return file_name


def make_unique(names: Iterable[str]) -> list[str]:
    """The same names, repeated ones numbered: a, a -> a, a_2."""
    taken: set[str] = set()
    result = []
    for name in names:
        candidate, number = name, 1
        while candidate in taken:
            number += 1
            candidate = f"{name}_{number}"
        taken.add(candidate)
        result.append(candidate)
    return result
