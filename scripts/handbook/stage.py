"""What the site is built from: the pages of the tree as they lie there, and beside them those made from schemas."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from scripts.handbook.http_pages import http_pages
from scripts.handbook.process_inputs import pages

ROOT = Path(__file__).resolve().parents[2]
TOP_PAGES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "client/README.md")
COPIED = {".md", ".png", ".svg", ".jpg", ".webp"}
SITE = Path("docs/site")  # configuration and start page, which lies at the root of the site
UNITS = "%|mm³|mm²|mm|cm³|cm²|m|ms|s|min|h|MB|MiB|kB|GB|°|faces"
NUMBER_AND_UNIT = re.compile(rf"(?<=\d) (?=(?:{UNITS})(?:\W|$))")  # a line of a narrow table cell must not end between them
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\((?!https?://|mailto:|#|/)([^)#\s]+)(#[^)\s]*)?\)")


def stage(folder: Path) -> None:
    """Fill an empty folder: the same tree as the repository's, so that links between pages need no change."""
    for source in sorted({*(ROOT / "docs").rglob("*"), *(ROOT / page for page in TOP_PAGES)}):
        path = source.relative_to(ROOT)
        if source.is_file() and source.suffix in COPIED and not path.is_relative_to(SITE):
            _copy(source, folder / path)
    _copy(ROOT / SITE / "index.md", folder / "index.md")
    _copy(ROOT / "openapi" / "openapi.json", folder / "openapi" / "openapi.json")
    for name, text in pages().items():
        page = folder / "docs" / "processes" / name
        # a process under way may have no page yet; tests/project/test_process_pages.py asks for one
        written = page.read_text(encoding="utf-8") if page.exists() else f"# Process `{page.stem}`\n"
        page.write_text(written + text, encoding="utf-8")
    for name, text in http_pages(ROOT / "openapi" / "openapi.json").items():
        page = folder / "docs" / "http" / name
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(text, encoding="utf-8")
    for page in sorted(folder.rglob("*.md")):
        page.write_text(_with_units_kept(_without_source_links(page, folder)), encoding="utf-8")


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def _with_units_kept(text: str) -> str:
    """In tables a number and its unit stay on one line."""
    return "\n".join(NUMBER_AND_UNIT.sub("\u00a0", line) if line.startswith("|") else line for line in text.split("\n"))


def _without_source_links(page: Path, folder: Path) -> str:
    """A link to a file of the tree that is no page of the site becomes its name; one that leads nowhere stays, and is told."""

    def mended(match: re.Match[str]) -> str:
        target = (page.parent / match[2]).resolve()
        in_tree = ROOT / target.relative_to(folder.resolve()) if target.is_relative_to(folder.resolve()) else None
        if target.is_file() or in_tree is None or not in_tree.exists():
            return match[0]
        name = f"`{in_tree.relative_to(ROOT)}`"
        return name if match[1].strip("`") in name else f"{match[1]} ({name})"

    return LINK.sub(mended, page.read_text(encoding="utf-8"))
