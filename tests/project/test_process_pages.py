"""Every process has a page; the table that explains its inputs names them all, with the defaults of the schema."""

import json
import re
from typing import Any

import pytest

from core.schema.processes import PROCESSES
from tests.project.sources import ROOT

ROW = re.compile(r"^\| (`[^|]+?) \|([^|]*)\| (.+) \|$", flags=re.MULTILINE)


def rows(process: str) -> list[tuple[list[str], str]]:
    """Keys and default of each row of the first table."""
    text = (ROOT / "docs" / "processes" / f"{process}.md").read_text(encoding="utf-8").replace("\\|", "/")
    table = re.search(r"^\| (?:key|input) \| default \| meaning \|\n(?:\|.*\n)+", text, flags=re.MULTILINE)
    assert table is not None, "a table `| key | default | meaning |`"
    return [(re.findall(r"`([^`]+)`", first), default.strip()) for first, default, _ in ROW.findall(table[0])]


def properties(process: str) -> dict[str, Any]:
    """Key -> its schema."""
    found: dict[str, Any] = PROCESSES[process].inputs.model_json_schema()["properties"]
    return found


@pytest.mark.parametrize("process", sorted(PROCESSES))
def test_table_names_every_input_and_no_other(process: str) -> None:
    named = [key for keys, _ in rows(process) for key in keys]
    assert sorted(named) == sorted(properties(process))


@pytest.mark.parametrize("process", sorted(PROCESSES))
def test_readme_leads_to_the_page(process: str) -> None:
    assert f"(docs/processes/{process}.md)" in (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("process", sorted(PROCESSES))
def test_page_tells_algorithm_promises_and_limits(process: str) -> None:
    text = (ROOT / "docs" / "processes" / f"{process}.md").read_text(encoding="utf-8")
    headings = set(re.findall(r"^## (.+)$", text, flags=re.MULTILINE))
    assert {"What is promised", "Limits"} - headings == set()
    assert "../algorithms/" in text or any(heading.startswith(("Algorithm", "How ", "The steps")) for heading in headings)


@pytest.mark.parametrize("process", sorted(PROCESSES))
def test_defaults_are_those_of_the_schema(process: str) -> None:
    schemas, wrong = properties(process), {}
    for keys, told in rows(process):
        cells = told.split("; " if ";" in told else ", ")
        for key, cell in zip(keys, cells, strict=True) if len(cells) == len(keys) else ((keys[0], told),):
            default = schemas[key].get("default")
            if isinstance(default, bool | int | float | str):  # null and lists are told in words
                word = default if isinstance(default, str) else json.dumps(default)
                same = cell.strip('`"').partition(" ")[0] == word or (not isinstance(default, str) and _number(cell) == default)
                if not same:
                    wrong[key] = (cell, default)
    assert wrong == {}


def _number(cell: str) -> float | None:
    try:
        return float(cell.partition(" ")[0])
    except ValueError:
        return None
