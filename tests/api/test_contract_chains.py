"""Chains of operations, each with the id the one before answered with: made, looked at, changed, taken back, made again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, settings
from schemathesis.core import NOT_SET
from schemathesis.core.transport import Response
from schemathesis.generation.case import Case

from api.openapi_links import MAKERS
from store.settings import Settings
from tests.api.contract import CHECKS, CONFIG, SECONDS_TO_ANSWER
from tests.api.live import Live, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer

DESCRIPTION = json.loads((Path(__file__).parents[2] / "openapi" / "openapi.json").read_text(encoding="utf-8"))
ENDLESS = ["streamEvents"]  # no worker is there, so no job ends
ANSWERS = [check for check in CHECKS if check.__name__ not in CONFIG["checks"]]  # bad requests are held in test_contract.py
PASSED_ON = {parameter for parameter, _ in MAKERS.values()}
FEW, MANY = 4, 150


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """Open, so every operation is let through the gate."""
    folder = tmp_path_factory.mktemp("chains")
    with serving(Settings(data_dir=folder, broker_url=shared_valkey.url, queue="tests-chains", quota_jobs=0)) as there:
        yield there


def follow(live: Live, chains: int) -> set[str]:
    """Run so many chains of up to eight steps; the operations that were answered well with an id of an earlier answer."""
    mesh = {"href": live.mesh_href(binary_stl())}
    good: dict[str, dict[str, Any]] = {  # what a random body is not: accepted
        "uploadMesh": {"files": {"file": ("skin.stl", binary_stl())}},
        "createUpload": {"headers": {"Tus-Resumable": "1.0.0", "Upload-Length": "84"}},
        "executeProcess": {"json": {"inputs": {"meshes": [mesh]}}},
        "createCohort": {"json": {"process": "validate", "subjects": [{"mesh": mesh}]}},
    }
    reached: set[str] = set()
    schema = schemathesis.openapi.from_dict(DESCRIPTION, config=schemathesis.Config.from_dict(CONFIG))
    machine: Any = schema.exclude(operation_id=ENDLESS).as_state_machine()

    class Chain(machine):  # type: ignore[misc]
        def get_call_kwargs(self, case: Case[Any]) -> dict[str, Any]:
            kwargs = {"base_url": live.url, "timeout": SECONDS_TO_ANSWER}
            if "wait" in str(case.headers.get("prefer", "")):  # it would
                case.headers["prefer"] = "respond-async"
            name = case.operation.definition.raw["operationId"]
            if name not in good:
                return kwargs
            case.body, case.media_type = NOT_SET, None
            case.headers.clear()
            if name == "executeProcess":
                case.path_parameters["process_id"] = "validate"
            return {**kwargs, **good[name]}

        def validate_response(self, response: Response, case: Case[Any], **kwargs: Any) -> None:
            case.validate_response(response, checks=ANSWERS)
            if response.status_code < 300 and PASSED_ON & set(case.path_parameters or {}):
                reached.add(case.operation.definition.raw["operationId"])

    Chain.run(
        settings=settings(
            max_examples=chains,
            stateful_step_count=8,
            derandomize=True,
            database=None,
            deadline=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )
    )
    return reached


def test_what_was_made_is_found_by_those_who_follow_the_links(live: Live) -> None:
    assert follow(live, FEW) & {"getJob", "getMesh", "getUpload", "getCohort", "dismissJob", "getJobInputs"}


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_many_chains(live: Live) -> None:
    """Long enough that everything that takes an id has been answered well."""
    reached = follow(live, MANY)
    assert reached >= {"getJob", "dismissJob", "relabelJob", "getMesh", "deleteMesh", "getUpload", "getCohort", "dismissCohort"}
