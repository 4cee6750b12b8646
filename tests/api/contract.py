"""The description of the API held against the API: cases made from openapi.json by Schemathesis, sent to a real server."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import schemathesis
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from schemathesis.checks import not_a_server_error
from schemathesis.generation import GenerationMode
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    missing_required_header,
    negative_data_rejection,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
    unsupported_method,
)

CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    negative_data_rejection,
    missing_required_header,
    unsupported_method,
]
REFUSALS = ["400", "401", "403", "404", "405", "406", "409", "412", "413", "415", "422", "431", "460"]  # 412, 460: tus
CONFIG = {"checks": {name: {"expected-statuses": REFUSALS} for name in ("negative_data_rejection", "missing_required_header")}}
MAY_BE_AWAY = "GET /readyz"  # a 503 is its work; that it is described is held all the same
SECONDS_TO_ANSWER = 30.0


@schemathesis.serializer("application/offset+octet-stream")
def send_bytes(_context: object, value: object) -> bytes:
    """The body of a piece of an upload is what it is."""
    return value if isinstance(value, bytes) else str(value).encode()


@dataclass(frozen=True)
class Server:
    """A server under test: keys by role ("" for none), and ids that are there beside those made up."""

    url: str
    keys: Mapping[str, str]
    ids: Mapping[str, tuple[str, ...]]
    description: dict[str, Any]


def operations(description: dict[str, Any]) -> list[str]:
    """ "GET /v1/jobs" and so on, in the order of the description."""
    return [f"{method.upper()} {path}" for path, methods in description["paths"].items() for method in methods]


def hold(server: Server, operation: str, examples: int, seed_number: int) -> int:
    """Send `examples` cases of one operation, half of them invalid on purpose; the number sent. Raises what a check finds."""
    method, _, path = operation.partition(" ")
    checks = CHECKS[1:] if operation == MAY_BE_AWAY else CHECKS
    schema = schemathesis.openapi.from_dict(server.description, config=schemathesis.Config.from_dict(CONFIG))
    described = schema[path][method]
    sent = 0

    @seed(seed_number)
    @settings(
        max_examples=examples,
        database=None,
        deadline=None,
        phases=[Phase.explicit, Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(data=st.data(), role=st.sampled_from(sorted(server.keys)), mode=st.sampled_from(list(GenerationMode)))
    def send(data: st.DataObject, role: str, mode: GenerationMode) -> None:
        nonlocal sent
        case = data.draw(described.as_strategy(generation_mode=mode))
        for name, known in server.ids.items():
            if name in (case.path_parameters or {}) and data.draw(st.booleans(), label=f"a real {name}"):
                case.path_parameters[name] = data.draw(st.sampled_from(known))
        headers = {"Authorization": f"Bearer {server.keys[role]}"} if server.keys[role] else {}
        if "wait" in str((case.headers or {}).get("prefer", "")):  # it would
            case.headers["prefer"] = "respond-async"
        response = case.call(base_url=server.url, headers=headers, timeout=SECONDS_TO_ANSWER)
        sent += 1
        case.validate_response(response, checks=checks)

    send()
    return sent
