"""Landing page, conformance, and the API's own description."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.responses import Response

from api.handbook_files import find_handbook
from api.links import BASE, CONFORMANCE_RELATION, HANDBOOK, JOB_LIST_RELATION, OPENAPI_3_0, PROCESSES_RELATION, link
from api.openapi import openapi_bytes
from api.responses import problems
from api.schemas.landing import Conformance, LandingPage
from api.version import SERVER_VERSION

router = APIRouter(tags=["Capabilities"])

_CLASSES = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"
CONFORMANCE_CLASSES = tuple(
    _CLASSES + name for name in ("core", "ogc-process-description", "json", "job-list", "dismiss", "callback", "oas30")
)


@router.get("/", include_in_schema=False)  # OWSLib asks for the base with a slash
@router.get("", operation_id="getLandingPage", responses=problems())
def get_landing_page(request: Request) -> LandingPage:
    """Where everything is."""
    told = link(request, HANDBOOK, "service-doc", media_type="text/html", title="Documentation")
    documentation = (told,) if find_handbook() else ()
    return LandingPage(
        title="Integument",
        description="Mesh-processing server for computational human models: proven nested shells over a REST job queue",
        version=SERVER_VERSION,
        links=(
            link(request, BASE, "self", title="This page"),
            link(request, f"{BASE}/openapi.json", "service-desc", media_type=OPENAPI_3_0, title="OpenAPI"),
            link(request, f"{BASE}/conformance", CONFORMANCE_RELATION, title="Conformance classes"),
            link(request, f"{BASE}/conformance", "conformance", title="Conformance classes"),
            link(request, f"{BASE}/processes", PROCESSES_RELATION, title="Processes"),
            link(request, f"{BASE}/jobs", JOB_LIST_RELATION, title="Jobs"),
            link(request, f"{BASE}/meshes", "collection", title="Uploaded meshes"),
            *documentation,
        ),
    )


@router.get("/conformance", operation_id="getConformance", responses=problems())
def get_conformance() -> Conformance:
    """The conformance classes of OGC API - Processes Part 1 this server claims."""
    return Conformance(conforms_to=CONFORMANCE_CLASSES)


@router.get("/openapi.json", operation_id="getOpenapi", response_class=Response, responses=problems())
def get_openapi(request: Request) -> Response:
    """This description, OpenAPI 3.0."""
    return Response(openapi_bytes(request.app), media_type=OPENAPI_3_0)
