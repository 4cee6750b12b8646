"""Every code a client may see is documented, and no documented code is history."""

import ast

import pytest

from tests.project.sources import codes_in, name_of, source_files, table, tree_of

FAULTS = {"InputError": "input", "LimitError": "limit", "StateError": "state", "InternalError": "internal"}


@pytest.fixture(scope="module")
def used() -> dict[str, str]:
    """Code -> the first place it is written at."""
    places: dict[str, str] = {}
    for path in source_files():
        for code, line in codes_in(tree_of(path)):
            places.setdefault(code, f"{name_of(path)}:{line}")
    return places


def test_every_code_has_a_row(used: dict[str, str]) -> None:
    documented = {row[0] for name in ("errors.md", "findings.md") for row in table(name)}
    assert {code: place for code, place in used.items() if code not in documented} == {}


@pytest.mark.parametrize("name", ["errors.md", "findings.md"])
def test_no_row_is_stale_doubled_empty_or_out_of_order(used: dict[str, str], name: str) -> None:
    rows = table(name)
    codes = [row[0] for row in rows]
    assert [code for code in codes if code not in used] == []
    assert codes == sorted(set(codes))
    assert [row for row in rows if not all(row)] == []


def test_faults_are_documented_as_they_are_raised() -> None:
    documented = {row[0]: row[1] for row in table("errors.md")}
    wrong = {}
    for path in source_files():
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FAULTS and node.args:
                code = node.args[0]
                if not isinstance(code, ast.Constant) or not isinstance(code.value, str):
                    continue  # handed through; the place it comes from is checked for the row itself
                if documented.get(code.value) != FAULTS[node.func.id]:
                    wrong[f"{name_of(path)}:{node.lineno} {code.value}"] = documented.get(code.value)
    assert wrong == {}
