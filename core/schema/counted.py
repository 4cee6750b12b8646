"""Numbers of things in sentences."""


def counted(count: int, noun: str) -> str:
    """`1 place`, `12 places`; for nouns whose plural takes an s."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
