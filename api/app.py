"""The application: `create_app(settings)`, and nothing at import time."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware

from api.body_limit import BodyLimit
from api.gate import Gate
from api.links import BASE
from api.openapi import install_openapi
from api.partial_file import sweep_partial_files
from api.problem_handlers import install_problem_handlers
from api.request_context import LOOPBACK_HOSTS, RequestContext
from api.request_folder import LEFT_BEHIND_S, sweep_incoming
from api.request_log import RequestLog
from api.routes import (
    attempts,
    callbacks,
    cohorts,
    ears,
    events,
    health,
    inputs,
    jobs,
    landing,
    meshes,
    page,
    processes,
    results,
    uploads,
)
from api.services import Services, make_services
from api.version import SERVER_VERSION
from core.errors import IntegumentError
from store.settings import Settings

logger = logging.getLogger(__name__)

SWEEP_S = 600.0

DESCRIPTION = """\
Mesh-processing server for computational human models. Jobs follow OGC API - Processes Part 1: Core 1.0: upload a mesh
(`POST /v1/meshes`), execute a process on it (`POST /v1/processes/{id}/execution`), follow the job (`GET /v1/jobs/{id}`, or its
events), fetch the results. Lengths are in mm. Every error is an RFC 9457 problem with a stable `code`.
"""


def create_app(settings: Settings) -> FastAPI:
    """An application of its own for every call. Database and child processes are started by its lifespan."""
    services = make_services(settings)
    app = FastAPI(
        title="Integument",
        version=SERVER_VERSION,
        description=DESCRIPTION,
        openapi_url=None,  # served below /v1, in OpenAPI 3.0
        docs_url=None,  # the framework's pages load scripts from elsewhere
        redoc_url=None,
        redirect_slashes=False,
        separate_input_output_schemas=False,
        lifespan=_lifespan,
        middleware=[
            Middleware(RequestLog, tally=services.http_tally),
            Middleware(RequestContext, allowed_hosts=_allowed_hosts(settings)),
            Middleware(Gate, admission=services.admission, limiter=services.limiter, trail=services.trail, disk=services.disk),
            Middleware(BodyLimit, counts_itself=_takes_files),
        ],
    )
    app.state.services = services
    install_problem_handlers(app)
    for module in (landing, meshes, ears, uploads, processes, jobs, cohorts, results, events, callbacks, attempts, inputs):
        app.include_router(module.router, prefix=BASE)
    app.include_router(health.router)
    app.include_router(page.page_router())
    app.include_router(page.handbook_router())
    install_openapi(app)
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    await run_in_threadpool(services.db.migrate)
    await run_in_threadpool(sweep_incoming, services.incoming_dir, LEFT_BEHIND_S)
    services.checkpointer.start()
    services.trail.start()
    services.http_tally.start()
    services.ringer.start()
    services.nursery.start()  # loads in the background while the first requests come
    sweeping = asyncio.create_task(_sweep_uploads(services))
    watching = asyncio.create_task(services.watch.run())
    try:
        yield
    finally:
        sweeping.cancel()
        watching.cancel()
        services.drain.begin()
        await run_in_threadpool(services.nursery.stop)
        await run_in_threadpool(services.trail.stop)
        await run_in_threadpool(services.http_tally.stop)
        await run_in_threadpool(services.ringer.stop)
        await run_in_threadpool(services.checkpointer.stop)
        services.doorbell.close()
        services.limiter.close()
        services.admission.close()
        services.recent_jobs.close()
        services.db.close()


async def _sweep_uploads(services: Services) -> None:
    """Uploads nobody went on with: their rows, then their files."""
    while True:
        try:
            await run_in_threadpool(services.uploads.sweep)
            await run_in_threadpool(sweep_partial_files, services.uploads_dir, services.uploads.known)
        except IntegumentError as error:
            logger.warning("uploads are swept later: %s", error)
        await asyncio.sleep(SWEEP_S)


def _takes_files(method: str, path: str) -> bool:
    return path in (f"{BASE}/meshes", f"{BASE}/cohort-archives") or (method == "PATCH" and path.startswith(f"{BASE}/uploads/"))


def _allowed_hosts(settings: Settings) -> frozenset[str]:
    bound = f"[{settings.host}]" if ":" in settings.host else settings.host
    return LOOPBACK_HOSTS | {bound} | frozenset(settings.allowed_hosts)
