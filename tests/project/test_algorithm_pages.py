"""The parameters that an algorithm page states are those of the code: `docs/algorithms/x.md` speaks of `core.x`."""

from functools import reduce
from importlib import import_module
from importlib.util import find_spec

import pytest

from tests.project.sources import ROOT, table

PAGES = sorted((ROOT / "docs" / "algorithms").glob("*.md"))
PARAMETERS = [
    (page.stem, *row[:2])
    for page in PAGES
    for row in table(f"algorithms/{page.name}")
    if "." in row[0] and row[1].replace(".", "").isdigit()
]


@pytest.mark.parametrize(("package", "name", "value"), PARAMETERS)
def test_parameter_is_as_stated(package: str, name: str, value: str) -> None:
    module, *path = name.split(".")
    own = f"core.{package}.{module}"
    found = import_module(own if find_spec(own) else f"core.geometry.{module}")
    if hasattr(found, "__path__"):  # a package of its own: `intersections.unfold.STEPS`
        found = import_module(f"{own}.{path.pop(0)}")
    assert float(value) == reduce(getattr, path, found)


def test_every_parameter_row_was_read() -> None:
    page = (ROOT / "docs" / "algorithms" / "shells.md").read_text(encoding="utf-8")
    assert (
        len([row for row in PARAMETERS if row[0] == "shells"]) == sum(line.startswith("| `") for line in page.splitlines()) > 15
    )
