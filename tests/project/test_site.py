"""The documentation site is built without a warning, asks nothing of any other host, and says what the schemas say."""

import re
from pathlib import Path

import pytest

from core.schema.processes import PROCESSES
from scripts.docs import build
from scripts.handbook.stage import stage
from tests.project.sources import ROOT

OUTSIDE = re.compile(r"""<(?:script|link|img|iframe|source)[^>]+(?:src|href)=["'](?:https?:)?//[^"']+""")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pages, out = tmp_path_factory.mktemp("pages"), tmp_path_factory.mktemp("site")
    stage(pages)
    done = build(pages, out)
    assert done.returncode == 0, done.stderr
    return out


def test_pages_fetch_nothing_from_elsewhere(site: Path) -> None:
    pages = list(site.rglob("*.html"))
    assert len(pages) > 40
    assert {
        page.name: OUTSIDE.findall(page.read_text(encoding="utf-8")) for page in pages if OUTSIDE.search(page.read_text())
    } == {}
    for style in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(https?:)?//", style.read_text(encoding="utf-8")), style


@pytest.mark.parametrize("process", sorted(PROCESSES))
def test_page_of_a_process_has_every_input_of_its_schema(site: Path, process: str) -> None:
    page = (site / "docs" / "processes" / f"{process}.html").read_text(encoding="utf-8")
    reference = page.partition('id="inputs-in-full"')[2]
    for key in PROCESSES[process].inputs.model_json_schema()["properties"]:
        assert f'<span class="pre">{key}</span>' in reference
    for output in PROCESSES[process].outputs:
        assert f'<span class="pre">{output}</span>' in reference


def test_a_default_is_told_without_what_its_parts_have_anyway(site: Path) -> None:
    page = (site / "docs" / "processes" / "prepare.html").read_text(encoding="utf-8")
    words = re.sub(r"<[^>]+>", "", page.partition('id="inputs-in-full"')[2])
    assert "keep_largest&quot;, &quot;min_piece_share" not in words
    assert "[{&quot;name&quot;: &quot;fat&quot;, &quot;depth_mm&quot;: 1.0}" in words


def test_numbers_in_tables_are_not_parted_from_their_units(site: Path) -> None:
    assert "0.0503\u00a0mm" in (site / "README.html").read_text(encoding="utf-8")


def test_every_route_is_in_the_http_reference(site: Path) -> None:
    routes = set(re.findall(r'^    "(/[^"]*)": \{$', (ROOT / "openapi" / "openapi.json").read_text(), flags=re.MULTILINE))
    written = "".join(page.read_text(encoding="utf-8") for page in (site / "docs" / "http").glob("*.html"))
    assert len(routes) > 20
    assert {route for route in routes if f"{route}</span>" not in written} == set()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[gone](docs/gone.md)", "gone.md"),
        ("[no such part](docs/cli.md#no-such-part)", "no-such-part"),
        ("![no picture](docs/gone.png)", "gone.png"),
    ],
)
def test_a_link_that_leads_nowhere_is_an_error(tmp_path: Path, text: str, told: str) -> None:
    pages = tmp_path / "pages"
    (pages / "docs").mkdir(parents=True)
    (pages / "index.md").write_text(f"# Start\n\n{text}\n\n```{{toctree}}\ndocs/cli\n```\n", encoding="utf-8")
    (pages / "docs" / "cli.md").write_text("# Command line\n\n## A part\n", encoding="utf-8")
    done = build(pages, tmp_path / "out")
    assert done.returncode != 0
    assert told in done.stderr
