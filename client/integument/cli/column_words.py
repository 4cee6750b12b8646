"""`--columns x y z Ex Ey Ez`: an option that takes all words up to the next option or file."""

from __future__ import annotations

import re
from collections.abc import Sequence

OPTION = "--columns"
_COLUMN = re.compile(r"^(-|\|?[A-Za-z_][\w|]*)$")  # no point and no slash: files have one


def join_columns(arguments: Sequence[str]) -> list[str]:
    """The words behind `--columns` as one; nothing behind `--` is touched."""
    joined: list[str] = []
    words = list(arguments)
    while words:
        word = words.pop(0)
        if word == "--":
            return [*joined, word, *words]
        joined.append(word)
        if word != OPTION or not words:
            continue
        named = [words.pop(0)]
        while words and _COLUMN.match(words[0]):
            named.append(words.pop(0))
        joined.append(" ".join(named))
    return joined


def split_columns(text: str) -> list[str]:
    """Names apart, whether commas or blanks part them."""
    return [word for word in re.split(r"[,;\s]+", text) if word]
