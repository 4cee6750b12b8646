"""What people call a job: a name and labels, shown as text and searched for."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field, StringConstraints

from api.schemas.document import Document
from store.job_words import JobWords

LABELS_AT_MOST = 20


def _printable(text: str) -> str:
    if not text.isprintable():
        raise ValueError("it has a character that cannot be shown, as a line break")
    return text


def _each_once(labels: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(labels))


Name = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200), AfterValidator(_printable)]
Label = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=64), AfterValidator(_printable)]
Labels = Annotated[tuple[Label, ...], Field(max_length=LABELS_AT_MOST), AfterValidator(_each_once)]


class JobWordsChange(Document):
    """What is left out stays; null takes a name away, an empty list all labels."""

    name: Name | None = Field(None, description="What people call the job, up to 200 characters")
    labels: Labels = Field((), description="All its labels from now on: up to 20, each up to 64 characters")

    def of(self, words: JobWords) -> JobWords:
        """The words after the change."""
        said = self.model_fields_set
        return JobWords(
            self.name if "name" in said else words.name,
            self.labels if "labels" in said else words.labels,
        )
