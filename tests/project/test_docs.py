"""Links of the docs lead somewhere; decisions are numbered; what the docs tell people to run exists."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.project.sources import ROOT, name_of

PAGES = sorted(path for folder in (ROOT, ROOT / "client", ROOT / "docs") for path in folder.glob("*.md")) + sorted(
    path for folder in ("adr", "algorithms") for path in (ROOT / "docs" / folder).glob("*.md")
)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_to_files(page: Path) -> None:
    targets = re.findall(r"\]\((?!https?://|#|mailto:)([^)#]+)", page.read_text(encoding="utf-8"))
    assert [target for target in targets if not (page.parent / target).exists()] == []


def test_decisions_have_numbers_of_their_own_and_a_status() -> None:
    numbers = []
    for path in sorted((ROOT / "docs" / "adr").glob("*.md")):
        number = path.name[:4]
        text = path.read_text(encoding="utf-8")
        assert re.match(rf"# {int(number)}\. .+\n\n(Accepted|Superseded by \d+)\.\n", text)
        assert re.findall(r"^## (.+)$", text, flags=re.MULTILINE)[:3] == ["Context", "Decision", "Consequences"]
        numbers.append(number)
    assert len(set(numbers)) == len(numbers)


@pytest.mark.parametrize("module", ["api", "worker", "server", "store.migrate"])
def test_programs_of_the_operations_page_exist(module: str) -> None:
    assert f"python -m {module}" in (ROOT / "docs" / "operations.md").read_text(encoding="utf-8")
    path = ROOT / module.replace(".", "/")
    assert path.with_suffix(".py").exists() or (path / "__main__.py").exists()


def test_hooks_run_what_make_check_runs() -> None:
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"][0]["hooks"]
    entries = " ".join(hook["entry"] for hook in hooks)
    recipe = re.search(r"^check:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)
    assert recipe is not None
    for tool in re.findall(r"\$\(BIN\)/(\S+(?: scripts/\S+)?)", recipe[1]):
        assert tool in entries
    command = [str(Path(sys.executable).with_name("pre-commit")), "validate-config", str(ROOT / ".pre-commit-config.yaml")]
    assert subprocess.run(command, capture_output=True).returncode == 0
