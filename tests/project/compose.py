"""docker-compose.yml as Docker Compose would see it: variables replaced, merges applied, checked against the specification."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import compose_spec
import yaml

from tests.project.sources import ROOT

COMPOSE_FILE = ROOT / "docker-compose.yml"
SECRETS = {"POSTGRES_PASSWORD": "sesame1", "VALKEY_PASSWORD": "sesame2"}
VARIABLE = re.compile(r"\$\{(?P<name>[A-Z_]+)(?::(?P<kind>[-?])(?P<rest>[^}]*))?\}")


class UnsetVariableError(LookupError):
    """What Docker Compose refuses to start without."""


def interpolate(text: str, environment: Mapping[str, str]) -> str:
    """`${A}`, `${A:-default}` and `${A:?message}` as the Compose specification defines them."""

    def value(match: re.Match[str]) -> str:
        found = environment.get(match["name"], "")
        if found or match["kind"] is None:
            return found
        if match["kind"] == "?":
            raise UnsetVariableError(f"{match['name']}: {match['rest']}")
        return match["rest"]

    return VARIABLE.sub(value, text)


def read_compose(environment: Mapping[str, str]) -> dict[str, Any]:
    """The whole file. Raises: UnsetVariableError; ValueError where the specification knows better."""
    compose: dict[str, Any] = yaml.safe_load(interpolate(COMPOSE_FILE.read_text(encoding="utf-8"), environment))
    compose_spec.PyCompose.from_yaml(yaml.safe_dump(compose)).validate()
    return compose
