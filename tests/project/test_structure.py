"""The rules of CONTRIBUTING.md that a machine can check."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.project.sources import ROOT, name_of, source_files, tree_of

DUSTBINS = {"common", "helper", "helpers", "manager", "misc", "util", "utils"}
LONGEST = 400


def test_import_contracts_hold() -> None:
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"]
    outcome = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert outcome.returncode == 0, outcome.stdout


@pytest.mark.parametrize("path", source_files(), ids=name_of)
def test_file_keeps_the_house_rules(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    tree = tree_of(path)
    assert path.stem not in DUSTBINS
    assert len(text.splitlines()) <= LONGEST
    assert ast.get_docstring(tree) or not tree.body, "a module says what it is for"
    assert not re.search(r"\b(TODO|FIXME|XXX)\b", text)
    for node in ast.walk(tree):
        assert not isinstance(node, ast.Assert), f"line {node.lineno}: -O removes it; raise"
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"line {node.lineno}: relative import"
        if isinstance(node, ast.ExceptHandler):
            assert node.type is not None, f"line {node.lineno}: bare except"
            assert not isinstance(node.body[0], ast.Pass), f"line {node.lineno}: an error passed over in silence"
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and isinstance(tree, ast.Module):
            public = node in tree.body and not node.name.startswith("_")
            assert not public or ast.get_docstring(node), f"line {node.lineno}: {node.name} has no docstring"
