"""What people call a job: its name and labels, and the text in which a search looks for it."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass

SEARCH_CHARACTERS = 500  # part of an index: PostgreSQL takes at most 2704 bytes for one entry, and a character has up to four
WORDS_AT_MOST = 8  # of one search


@dataclass(frozen=True, slots=True)
class JobWords:
    """`labels` are in the order they were given, none twice."""

    name: str | None = None
    labels: tuple[str, ...] = ()


NO_WORDS = JobWords()


def search_text(job_id: str, process: str, words: JobWords, mesh_names: Iterable[str]) -> str:
    """Id, process, name, labels and names of the meshes, folded and cut: the name before what may be long."""
    told = [job_id, process, words.name or "", *words.labels, *dict.fromkeys(mesh_names)]
    return fold(" ".join(part for part in told if part))[:SEARCH_CHARACTERS]


def search_words(asked: str) -> tuple[str, ...]:
    """The words all of which have to occur."""
    return tuple(fold(asked).split()[:WORDS_AT_MOST])


def fold(text: str) -> str:
    """Upper and lower case are alike, and so are the ways to write an accent; databases differ in both."""
    return "".join(char for char in unicodedata.normalize("NFC", text.casefold()) if char.isprintable())
