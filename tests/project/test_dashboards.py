"""Alert rules, dashboard and docs name metrics and labels that the server really tells."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import promql_parser as promql
import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families

from core.errors import InputError
from store.job import JobFailure
from store.metric_family import FAMILIES
from store.settings import Settings
from store.stored_bytes import StoredBytes
from store.workers import WorkerWord
from tests.api.live import serving
from tests.project.sources import ROOT

DEPLOY = ROOT / "deploy"
OTHERS = {"up": frozenset({"job", "instance"})}
SCRAPED = frozenset({"job", "instance"})  # Prometheus adds them


@cache
def told_metrics() -> dict[str, frozenset[str]]:
    """Every series name a real server tells, with the names of its labels."""
    with tempfile.TemporaryDirectory() as folder, serving(Settings(data_dir=Path(folder))) as live:
        live.successful()
        live.failed(JobFailure.of(InputError("skin.not_closed", "3 open edges")))
        live.services.workers.beat(WorkerWord("a:1", "a", "0.1.0", 2, 16, 1000))
        StoredBytes(live.services.db).measure()
        live.client.get("/v1/jobs", headers={"Host": "evil.example"})
        text = live.client.get("/metrics").text
    told: dict[str, frozenset[str]] = {}
    for family in text_string_to_metric_families(text):
        for sample in family.samples:
            told[sample.name] = told.get(sample.name, frozenset()) | frozenset(sample.labels)
    for family in FAMILIES.values():  # those nothing was counted of here have no series yet
        names = [family.name] if not family.buckets else [f"{family.name}_{part}" for part in ("bucket", "sum", "count")]
        for name in names:
            told.setdefault(name, frozenset(family.labels) | ({"le"} if name.endswith("_bucket") else frozenset()))
    return told


def selectors(expression: Any) -> Iterator[Any]:
    """All vector selectors in an expression, and the labels it groups by."""
    if isinstance(expression, promql.VectorSelector):
        yield expression
    for part in ("lhs", "rhs", "expr", "param", "vector_selector", "args"):
        below = getattr(expression, part, None)
        for one in below if isinstance(below, list) else [below]:
            if one is not None and type(one).__module__.startswith(("promql", "builtins")) and not isinstance(one, str):
                yield from selectors(one)


def check(text: str) -> list[str]:
    """What an expression names that nobody tells; raises where it is no PromQL."""
    missing = []
    for selector in selectors(promql.parse(text)):
        labels = OTHERS.get(selector.name) or told_metrics().get(selector.name)
        if labels is None:
            missing.append(selector.name)
            continue
        used = {matcher.name for matcher in selector.matchers.matchers}
        missing += [f"{selector.name}{{{name}}}" for name in used - labels - SCRAPED]
    grouped = {label.strip() for group in re.findall(r"\bby \(([^)]*)\)", text) for label in group.split(",")}
    everything = frozenset().union(*told_metrics().values())
    return missing + [f"by ({name})" for name in grouped - everything]


def rules() -> list[dict[str, Any]]:
    (group,) = yaml.safe_load((DEPLOY / "prometheus" / "alerts.yml").read_text())["groups"]
    found: list[dict[str, Any]] = group["rules"]
    return found


@pytest.mark.parametrize("rule", rules(), ids=lambda rule: rule["alert"])
def test_an_alert_can_fire(rule: dict[str, Any]) -> None:
    assert check(rule["expr"]) == []
    assert set(rule) == {"alert", "expr", "for", "labels", "annotations"}
    assert rule["labels"]["severity"] in ("critical", "warning")
    used = set(re.findall(r"\$labels\.(\w+)", rule["annotations"]["summary"]))
    assert all(name in rule["expr"] or name in told_metrics()[rule["expr"].split()[0]] for name in used)


def test_the_check_sees_what_is_not_there() -> None:
    assert check("sum by (nothing) (integument_jobs{state='x'}) > integument_made_up") == [
        "integument_jobs{state}",
        "integument_made_up",
        "by (nothing)",
    ]
    with pytest.raises(ValueError, match="parenthesis"):
        check("sum by (")


def test_every_panel_shows_something() -> None:
    board = json.loads((DEPLOY / "grafana" / "dashboards" / "integument.json").read_text())
    expressions = [target["expr"] for panel in board["panels"] for target in panel["targets"]]
    assert {expression: missing for expression in expressions if (missing := check(expression))} == {}
    assert len({panel["id"] for panel in board["panels"]}) == len(board["panels"]) >= 20
    sources = yaml.safe_load((DEPLOY / "grafana" / "provisioning" / "datasources" / "prometheus.yml").read_text())["datasources"]
    assert {target["datasource"]["uid"] for panel in board["panels"] for target in panel["targets"]} == {sources[0]["uid"]}
    places = [panel["gridPos"] for panel in board["panels"]]
    assert all(place["x"] + place["w"] <= 24 for place in places)


def test_everything_that_is_told_is_on_the_dashboard_or_in_an_alert() -> None:
    shown = (DEPLOY / "grafana" / "dashboards" / "integument.json").read_text() + (
        DEPLOY / "prometheus" / "alerts.yml"
    ).read_text()
    ours = {re.sub(r"_(bucket|sum|count)$", "", name) for name in told_metrics() if name.startswith("integument_")}
    scaling = (DEPLOY / "kubernetes" / "base" / "scaling.yaml").read_text()
    assert [name for name in sorted(ours) if name not in shown + scaling] == []


def test_the_docs_list_every_metric_with_its_labels() -> None:
    page = (ROOT / "docs" / "operations.md").read_text(encoding="utf-8")
    listed = dict(re.findall(r"^\| `(integument_\w+)` \| ([^|]*) \|", page, flags=re.MULTILINE))
    ours: dict[str, frozenset[str]] = {}
    for name, labels in told_metrics().items():
        if name.startswith("integument_"):
            base = re.sub(r"_(bucket|sum|count)$", "", name)
            ours[base] = ours.get(base, frozenset()) | (labels - {"le"})
    assert {name: frozenset(re.findall(r"\w+", labels)) for name, labels in listed.items()} == ours


def test_prometheus_reads_the_rules_and_asks_one_address() -> None:
    config = yaml.safe_load((DEPLOY / "prometheus" / "prometheus.yml").read_text())
    (job,) = config["scrape_configs"]
    assert job["job_name"] == "integument"
    assert len(job["static_configs"][0]["targets"]) == 1
    assert (DEPLOY / "prometheus" / Path(config["rule_files"][0]).name).exists()
