"""What the server says of itself: OGC documents, schemas, OpenAPI."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.dialect import to_common_dialect
from core.schema.processes import PROCESSES
from scripts import openapi
from tests.api.live import Live

ROOT = Path(__file__).parents[2]
# what a schema may hold according to OpenAPI 3.0.3 (Schema Object) and OGC's schema.yaml
KEYWORDS = {
    *("title", "multipleOf", "maximum", "minimum", "maxLength", "minLength", "pattern", "maxItems", "minItems", "uniqueItems"),
    *("maxProperties", "minProperties", "required", "enum", "type", "not", "allOf", "oneOf", "anyOf", "items", "properties"),
    *("additionalProperties", "description", "format", "default", "nullable", "readOnly", "writeOnly", "example", "deprecated"),
    "contentMediaType",
}


def schemas_in(schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The schema and all below it."""
    yield schema
    for key in ("items", "not", "additionalProperties"):
        if isinstance(schema.get(key), dict):
            yield from schemas_in(schema[key])
    for key in ("anyOf", "oneOf", "allOf"):
        for one in schema.get(key, ()):
            yield from schemas_in(one)
    for one in schema.get("properties", {}).values():
        yield from schemas_in(one)


def test_the_landing_page_leads_everywhere(api: Live) -> None:
    page = api.client.get("/v1").json()
    for link in page["links"]:
        answer = httpx.get(link["href"])
        assert answer.status_code == 200, link
        assert answer.headers["content-type"] in (link["type"], f"{link['type']}; charset=utf-8")
    relations = {link["rel"] for link in page["links"]}
    assert {"self", "service-desc", "http://www.opengis.net/def/rel/ogc/1.0/processes"} <= relations
    assert {"http://www.opengis.net/def/rel/ogc/1.0/conformance", "http://www.opengis.net/def/rel/ogc/1.0/job-list"} <= relations


def test_only_what_is_there_is_claimed(api: Live) -> None:
    claimed = {uri.rpartition("/")[2] for uri in api.client.get("/v1/conformance").json()["conformsTo"]}
    assert claimed == {"core", "ogc-process-description", "json", "job-list", "dismiss", "callback", "oas30"}


def test_the_catalogue_leads_to_descriptions_and_executions(api: Live) -> None:
    listed = api.client.get("/v1/processes").json()["processes"]
    assert [process["id"] for process in listed] == list(PROCESSES)
    for summary in listed:
        assert summary["jobControlOptions"] == ["async-execute", "dismiss"]
        assert summary["outputTransmission"] == ["reference"]
        links = {link["rel"]: link["href"] for link in summary["links"]}
        described = httpx.get(links["self"]).json()
        assert summary.items() <= described.items()
        assert httpx.post(links["http://www.opengis.net/def/rel/ogc/1.0/execute"], json={"inputs": {}}).status_code == 422


@pytest.mark.parametrize("process_id", PROCESSES)
def test_every_input_has_a_schema_of_its_own(api: Live, process_id: str) -> None:
    process, described = PROCESSES[process_id], api.client.get(f"/v1/processes/{process_id}").json()
    assert set(described["inputs"]) == {name for name, field in process.inputs.model_fields.items() if not field.exclude}
    for name, told in described["inputs"].items():
        assert told["minOccurs"] == int(process.inputs.model_fields[name].is_required())
        assert told["maxOccurs"] == 1
        for schema in schemas_in(told["schema"]):
            assert set(schema) <= KEYWORDS, schema
            assert "$ref" not in schema
    assert set(process.outputs) <= set(described["outputs"])
    assert ("{layer}" in described["outputs"]) == process.names_layers
    assert ("{surface}" in described["outputs"]) == process.names_surfaces


def test_schemas_say_what_the_server_checks(api: Live) -> None:
    inputs = api.client.get("/v1/processes/shells").json()["inputs"]
    depth = inputs["layers"]["schema"]["items"]["properties"]["depth_mm"]
    assert {key: depth[key] for key in ("minimum", "maximum", "not")} == {"minimum": 0, "maximum": 100, "not": {"enum": [0]}}
    assert inputs["layers"]["schema"]["default"][0].items() >= {"name": "fat", "depth_mm": 1.0}.items()
    corner = inputs["regions"]["schema"]["items"]["properties"]["box_mm"]["properties"]["min"]
    assert (corner["items"], corner["minItems"], corner["maxItems"]) == ({"type": "number"}, 3, 3)
    depths = inputs["regions"]["schema"]["items"]["properties"]["depths_mm"]
    assert depths["additionalProperties"]["maximum"] == 100
    assert "Keys match ^[A-Za-z" in depths["description"]
    assert inputs["thin_policy"]["schema"]["enum"] == ["adapt", "fail"]


@pytest.mark.parametrize(
    ("schema", "rewritten"),
    [
        ({"const": "x"}, {"enum": ["x"]}),
        ({"exclusiveMinimum": 0, "exclusiveMaximum": 1}, {"minimum": 0, "maximum": 1, "not": {"enum": [0, 1]}}),
        (
            {"anyOf": [{"type": "string"}, {"type": "null"}], "default": None},
            {"type": "string", "nullable": True, "default": None},
        ),
        ({"anyOf": [{"$ref": "#/x"}, {"type": "null"}]}, {"allOf": [{"$ref": "#/x"}], "nullable": True}),
        ({"anyOf": [{"const": 1}, {"type": "object"}]}, {"anyOf": [{"enum": [1]}, {"type": "object"}]}),
        (
            {"anyOf": [{"type": "string"}, {"type": "number"}, {"type": "null"}]},
            {"anyOf": [{"type": "string"}, {"type": "number"}], "nullable": True},
        ),
        ({"prefixItems": [{"type": "string"}, {"const": 2}]}, {"items": {"anyOf": [{"type": "string"}, {"enum": [2]}]}}),
        ({"properties": {"const": {"const": 3}}}, {"properties": {"const": {"enum": [3]}}}),
        ({"examples": [1, 2]}, {"example": 1}),
        ({"type": "string", "contentMediaType": "application/octet-stream"}, {"type": "string", "format": "binary"}),
    ],
)
def test_schemas_are_rewritten_without_change_of_meaning(schema: dict[str, Any], rewritten: dict[str, Any]) -> None:
    before = json.dumps(schema)
    assert to_common_dialect(schema) == rewritten
    assert json.dumps(schema) == before


def test_references_are_resolved_where_definitions_are_given() -> None:
    definitions = {"Inner": {"type": "object", "properties": {"deep": {"$ref": "#/$defs/Leaf"}}}, "Leaf": {"const": 1}}
    schema = {"$ref": "#/$defs/Inner", "description": "here"}
    assert to_common_dialect(schema, definitions) == {
        "type": "object",
        "properties": {"deep": {"enum": [1]}},
        "description": "here",
    }


def test_what_the_dialect_cannot_say_is_not_said_wrongly() -> None:
    with pytest.raises(ValueError, match="several key patterns"):
        to_common_dialect({"patternProperties": {"^a": {}, "^b": {}}})


def test_openapi_is_3_0_through_and_through(api: Live) -> None:
    response = api.client.get("/v1/openapi.json")
    assert response.headers["content-type"] == "application/vnd.oai.openapi+json;version=3.0"
    document = response.json()
    assert document["openapi"] == "3.0.3"
    for name, schema in document["components"]["schemas"].items():
        for one in schemas_in(schema):
            assert set(one) <= KEYWORDS | {"$ref"}, name
    text = response.text
    for name in {part.split('"')[0] for part in text.split("#/components/schemas/")[1:]}:
        assert name in document["components"]["schemas"]
    ids = [operation["operationId"] for path in document["paths"].values() for operation in path.values()]
    assert len(ids) == len(set(ids))


def test_the_committed_description_is_the_one_served(api: Live) -> None:
    assert (ROOT / "openapi" / "openapi.json").read_bytes() == api.client.get("/v1/openapi.json").content


def test_drift_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "openapi" / "openapi.json"
    monkeypatch.setattr(openapi, "TARGET", target)
    assert openapi.main(["--check"]) == 1
    assert openapi.main([]) == 0
    assert openapi.main(["--check"]) == 0
    target.write_text(target.read_text().replace("uploadMesh", "sendMesh"))
    capsys.readouterr()
    assert openapi.main(["--check"]) == 1
    assert '-        "operationId": "sendMesh"' in capsys.readouterr().out
    assert openapi.main(["--fix"]) == 2
