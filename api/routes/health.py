"""Is the process alive, can it do its work, and how much is there to do."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

from fastapi import APIRouter, Query
from starlette.responses import PlainTextResponse

from api.metrics import render_metrics
from api.readiness import CHECKS
from api.responses import problems
from api.schemas.health import Health, Readiness
from api.services import Services, ServicesDep
from core.errors import StateError

router = APIRouter(tags=["Health"])

METRICS_MEDIA_TYPE = "text/plain; version=0.0.4; charset=utf-8"

PartName = Literal["database", "broker", "blobs", "disk", "drain", "workers"]
ExcludeParameter = Annotated[tuple[PartName, ...], Query(description="Parts not to look at; may be repeated")]


@router.get("/healthz", operation_id="getHealth", responses=problems())
async def get_health() -> Health:
    """The process answers; nothing else is asked."""
    return Health()


@router.get("/readyz", operation_id="getReadiness", responses=problems(422, 503))
def get_readiness(services: ServicesDep, exclude: ExcludeParameter = ()) -> Readiness:
    """Database, broker, blob store, disk and a worker are there and the server is not stopping; else 503 says what is missing.

    `exclude=workers` asks whether requests can be served, whoever runs the jobs later."""
    asked = {name: check for name, check in CHECKS.items() if name not in exclude}
    missing = {name: said for name, check in asked.items() if (said := _ask(check, services)) is not None}
    if missing:
        told = "; ".join(f"{name}: {said}" for name, said in missing.items())
        error = StateError("server.not_ready", f"Not ready: {told}")
        error.facts.update(missing)
        raise error
    return Readiness(checks=dict.fromkeys(asked, "ok"))


@router.get(
    "/metrics",
    operation_id="getMetrics",
    response_class=PlainTextResponse,
    responses={200: {"description": "Prometheus text", "content": {"text/plain": {}}}, **problems()},
)
def get_metrics(services: ServicesDep) -> PlainTextResponse:
    """What there is to do, who is there, and what was counted: docs/operations.md names all of it."""
    return PlainTextResponse(render_metrics(services), media_type=METRICS_MEDIA_TYPE)


def _ask(check: Callable[[Services], str | None], services: Services) -> str | None:
    """What is wrong, in words without addresses or passwords; None if nothing is."""
    try:
        return check(services)
    except Exception as error:  # noqa: BLE001 - whatever a driver raises means the same here
        return type(error).__name__
