"""Where a coil stands: 16 numbers in a file of text."""

from __future__ import annotations

import re
from pathlib import Path

from integument.errors import ArgumentError

MOST_CHARACTERS = 10_000


def read_placement(path: Path) -> list[list[float]]:
    """Rows of a 4 x 4 matrix, parted by blanks, commas, semicolons or brackets, as MATLAB and SimNIBS print it.

    Raises: ArgumentError."""
    try:
        with path.open(encoding="utf-8") as file:
            words = re.split(r"[\s,;\[\]]+", file.read(MOST_CHARACTERS).strip())
        numbers = [float(word) for word in words if word]
    except (OSError, UnicodeDecodeError) as error:
        raise ArgumentError(f"cannot read the placement {path}: {error}") from error
    except ValueError as error:
        raise ArgumentError(f"{path} holds something else than numbers: {error}") from error
    if len(numbers) != 16:
        raise ArgumentError(f"{path} holds {len(numbers)} numbers; the 16 of a 4 x 4 matrix, row by row, are wanted")
    return [numbers[start : start + 4] for start in range(0, 16, 4)]
