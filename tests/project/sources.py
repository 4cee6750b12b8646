"""What the project tests read: the source files, their literals, and the tables of the docs."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from matplotlib import rcParams

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("api", "client/integument", "core", "sandbox", "server", "store", "worker")
CODE = re.compile(r"^[a-z][a-z0-9_]*\.[a-z][a-z0-9_]*$")
FILE_SUFFIXES = {
    *("csv", "html", "js", "json", "md", "msh", "vtu", "lock", "log", "mat", "mesh", "npz", "obj", "part"),
    *("ply", "png", "sock", "sqlite3", "stl", "tmp", "txt", "yaml", "zip"),
}
# a Celery task, a column, an ASGI event, files of control groups, an attribute of traces
OTHER_NAMES = {"jobs.run", "jobs.id", "http.disconnect", "memory.max", "memory.limit_in_bytes", "service.name"}


def source_files() -> list[Path]:
    """Every Python file of the packages; the migrations, which nobody edits once they are out, apart."""
    return sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py") if path.parent.name != "versions")


def name_of(path: Path) -> str:
    """As a reader looks for it."""
    return str(path.relative_to(ROOT))


def tree_of(path: Path) -> ast.Module:
    """Parsed."""
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def is_code(text: str) -> bool:
    """True for `noun.reason`, unless it is known to name something else: a file, a module, a setting of matplotlib."""
    if not CODE.match(text) or text.rpartition(".")[2] in FILE_SUFFIXES or text in {*OTHER_NAMES, *rcParams}:
        return False
    return text.partition(".")[0] not in ("core", "integument") and not _is_module(text)


def _is_module(name: str) -> bool:
    package, _, _ = name.partition(".")
    return (ROOT / package / "__init__.py").exists() and find_spec(name) is not None


def codes_in(tree: ast.Module) -> Iterator[tuple[str, int]]:
    """Every code written out in the file, with its line."""
    docstrings = {id(text) for node in ast.walk(tree) if isinstance(node, ast.Expr) for text in [node.value]}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings and is_code(node.value):
            yield node.value, node.lineno


def table(name: str) -> list[list[str]]:
    """The cells of all rows of all tables in docs/`name`, heads and rules apart; code marks are taken off the first cell."""
    rows = []
    for line in (ROOT / "docs" / name).read_text(encoding="utf-8").splitlines():
        if line.startswith("| `"):
            cells = [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            rows.append([cells[0].strip("`"), *cells[1:]])
    return rows
