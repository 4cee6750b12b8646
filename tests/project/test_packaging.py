"""Licence, metadata and lock file agree."""

import tomllib
from importlib.metadata import entry_points, metadata
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

from server.serve import serve
from tests.project.sources import ROOT

LICENCE = "AGPL-3.0-or-later"
PROJECTS = {"integument-server": ROOT / "pyproject.toml", "integument": ROOT / "client" / "pyproject.toml"}


def read(path: Any) -> dict[str, Any]:
    with path.open("rb") as file:
        return tomllib.load(file)


def test_licence_text_is_the_affero_gpl() -> None:
    text = (ROOT / "LICENSE").read_text()
    assert "GNU AFFERO GENERAL PUBLIC LICENSE" in text
    assert "Version 3, 19 November 2007" in text


@pytest.mark.parametrize("name", PROJECTS)
def test_both_distributions_say_so(name: str) -> None:
    assert read(PROJECTS[name])["project"]["license"] == LICENCE
    assert metadata(name)["License-Expression"] == LICENCE


@pytest.mark.parametrize("name", PROJECTS)
def test_lock_file_is_in_step_with_the_project(name: str) -> None:
    project = read(PROJECTS[name])
    locked = next(package for package in read(ROOT / "uv.lock")["package"] if package["name"] == name)
    assert read(ROOT / "uv.lock")["requires-python"] == ">=3.11, <3.14"
    extras = [text for texts in project["project"].get("optional-dependencies", {}).values() for text in texts]
    wanted = {_plain(Requirement(text)) for text in [*project["project"]["dependencies"], *extras]}
    assert {(row["name"], row.get("specifier", "")) for row in locked["metadata"]["requires-dist"]} == wanted
    groups = project.get("dependency-groups", {})
    for group, rows in locked["metadata"].get("requires-dev", {}).items():
        asked = {_plain(Requirement(text)) for text in _flat(groups, group)}
        assert {(row["name"], str(SpecifierSet(row.get("specifier", "")))) for row in rows} == asked


def _flat(groups: dict[str, list[Any]], name: str) -> list[str]:
    return [
        text for entry in groups[name] for text in ([entry] if isinstance(entry, str) else _flat(groups, entry["include-group"]))
    ]


def _plain(requirement: Requirement) -> tuple[str, str]:
    return requirement.name.lower().replace("_", "-"), str(requirement.specifier)


def test_client_finds_the_server_installed_beside_it() -> None:
    (entry,) = entry_points(group="integument.server", name="serve")
    assert entry.load() is serve
