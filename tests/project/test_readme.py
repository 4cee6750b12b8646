"""The numbers README compares us and others by are those of docs/benchmarks.md, rounded."""

import re

import pytest

from tests.project.sources import ROOT

NUMBER = re.compile(r"\d[\d,]*(?:\.\d+)?(?:e-\d+)?")
SHELLS = {  # row of README -> row of the benchmarks
    "Integument": "integument",
    "offset along vertex normals": "vertex-normal offset",
    "pymeshlab resampled offset, 2 mm": "pymeshlab resampled offset 2 mm, decimated",
    "level set, 2 mm (libigl distances)": "level set 2 mm, decimated",
}
MEASURES = {
    "intersecting pairs": "exact crossing pairs",
    "smallest gap": "smallest gap mm",
    "on target 1 mm / 3 mm": "on target",
    "lowest q of the shells": "min q",
    "filled with tetrahedra by TetGen": "TetGen pYQ",
}
HEALERS = {
    "Integument": "integument",
    "pymeshfix": "pymeshfix",
    "trimesh": "trimesh, all repairs",
    "pymeshlab": "pymeshlab, gentle filters",
}
OUTCOMES = {"healed to ready": "healed to ready", "handed out, and wrong": "wrong"}


def table(page: str, below: str) -> dict[str, dict[str, str]]:
    """Row -> column -> cell of the first table behind these words."""
    text = (ROOT / page).read_text(encoding="utf-8").partition(below)[2]
    found = re.search(r"^\|.*\n\|[ |:-]+\n(?:\|.*\n)+", text, flags=re.MULTILINE)
    assert found is not None, f"{page} has no table behind `{below}`"
    head, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in found[0].splitlines())
    return {row[0]: dict(zip(head, row, strict=True)) for row in rows}


def require_rounded(shown: str, measured: str) -> None:
    """Every number of one cell is that of the other, with as many digits as it has."""
    numbers, sources = ([word.replace(",", "") for word in NUMBER.findall(cell)] for cell in (shown, measured))
    assert len(numbers) == len(sources), f"`{shown}` against `{measured}`"
    for number, source in zip(numbers, sources, strict=True):
        half = 0.5 * 10.0 ** -len(number.partition(".")[2])
        assert abs(float(source) - float(number)) <= half * (1 + 1e-9), f"`{shown}` against `{measured}`"


@pytest.mark.parametrize("method", sorted(SHELLS))
def test_shells_are_as_measured(method: str) -> None:
    shown = table("README.md", "## What it is measured at")[method]
    measured = table("docs/benchmarks.md", "### 107,024 faces, 1 mm and 3 mm")[SHELLS[method]]
    for column, source in MEASURES.items():
        require_rounded(shown[column], measured[source])


@pytest.mark.parametrize("healer", sorted(HEALERS))
def test_healing_is_as_measured(healer: str) -> None:
    shown = table("README.md", "Repair of 179 surfaces")
    measured = table("docs/benchmarks.md", "## Healing")[HEALERS[healer]]
    for outcome, column in OUTCOMES.items():
        require_rounded(shown[outcome][healer], measured[column])


@pytest.mark.parametrize(
    ("stale", "measured"), [("44 %", "42.5 %"), ("0.0504 mm", "0.0503"), ("14,748", "14,747"), ("no", "982,017")]
)
def test_another_number_is_told(stale: str, measured: str) -> None:
    with pytest.raises(AssertionError):
        require_rounded(stale, measured)
