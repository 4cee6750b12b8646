"""Options that hold for every command may stand anywhere on the line."""

from __future__ import annotations

from collections.abc import Sequence

SWITCHES = frozenset({"--json", "--quiet", "-q"})
WITH_VALUE = frozenset({"--server", "--key-file"})


def split_global(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """(global options, the rest in its order); nothing behind `--` is touched."""
    found: list[str] = []
    rest: list[str] = []
    words = iter(arguments)
    for word in words:
        if word == "--":
            rest += [word, *words]
        elif word in SWITCHES or ("=" in word and word.partition("=")[0] in WITH_VALUE):
            found.append(word)
        elif word in WITH_VALUE:
            found += [word, *([value] if (value := next(words, None)) is not None else [])]
        else:
            rest.append(word)
    return found, rest
