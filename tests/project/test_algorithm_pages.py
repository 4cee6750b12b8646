"""The parameters that the algorithm page states are those of the code."""

from functools import reduce
from importlib import import_module

import pytest

from tests.project.sources import ROOT, table

PARAMETERS = [row for row in table("algorithms/shells.md") if "." in row[0] and row[1].replace(".", "").isdigit()]


@pytest.mark.parametrize(("name", "value"), [row[:2] for row in PARAMETERS])
def test_parameter_is_as_stated(name: str, value: str) -> None:
    module, _, path = name.partition(".")
    assert float(value) == reduce(getattr, path.split("."), import_module(f"core.shells.{module}"))


def test_every_parameter_row_was_read() -> None:
    page = (ROOT / "docs" / "algorithms" / "shells.md").read_text(encoding="utf-8")
    assert len(PARAMETERS) == sum(line.startswith("| `") for line in page.splitlines()) > 15
