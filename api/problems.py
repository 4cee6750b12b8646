"""From a failure to its answer: which HTTP status a code gets, and the RFC 9457 body."""

from __future__ import annotations

import math
from http import HTTPStatus

from starlette.requests import Request
from starlette.responses import Response

from api.audited import CODE_KEY
from api.request_id import request_id_of
from api.schemas.problem import Problem, Violation
from api.violations import ViolationsError
from core.errors import Fact, Fault, IntegumentError
from core.schema.finding import Finding

MEDIA_TYPE = "application/problem+json"
OGC_EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"

CHECKSUM_MISMATCH = 460  # of tus

STATUS_BY_FAULT: dict[Fault, int] = {
    "input": HTTPStatus.UNPROCESSABLE_ENTITY,
    "limit": HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
    "state": HTTPStatus.CONFLICT,
    "internal": HTTPStatus.INTERNAL_SERVER_ERROR,
}
# only what differs from its fault's status
STATUS_BY_CODE: dict[str, int] = {
    "access.key_expired": HTTPStatus.UNAUTHORIZED,
    "access.key_invalid": HTTPStatus.UNAUTHORIZED,
    "access.key_missing": HTTPStatus.UNAUTHORIZED,
    "access.scope_missing": HTTPStatus.FORBIDDEN,
    "blobs.unavailable": HTTPStatus.SERVICE_UNAVAILABLE,
    "cohort.not_found": HTTPStatus.NOT_FOUND,
    "database.unavailable": HTTPStatus.SERVICE_UNAVAILABLE,
    "format.unknown": HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
    "idempotency.key_invalid": HTTPStatus.BAD_REQUEST,
    "idempotency.mismatch": HTTPStatus.UNPROCESSABLE_ENTITY,
    "job.no_report": HTTPStatus.NOT_FOUND,
    "job.no_results": HTTPStatus.NOT_FOUND,
    "job.not_found": HTTPStatus.NOT_FOUND,
    "mesh.not_found": HTTPStatus.NOT_FOUND,
    "method.not_allowed": HTTPStatus.METHOD_NOT_ALLOWED,
    "output.not_found": HTTPStatus.NOT_FOUND,
    "handbook.not_built": HTTPStatus.SERVICE_UNAVAILABLE,
    "handbook.not_found": HTTPStatus.NOT_FOUND,
    "page.not_built": HTTPStatus.SERVICE_UNAVAILABLE,
    "process.not_found": HTTPStatus.NOT_FOUND,
    "quota.bytes": HTTPStatus.FORBIDDEN,
    "quota.jobs": HTTPStatus.TOO_MANY_REQUESTS,
    "range.not_satisfiable": HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE,
    "rate.exceeded": HTTPStatus.TOO_MANY_REQUESTS,
    "request.host_refused": HTTPStatus.BAD_REQUEST,
    "request.malformed": HTTPStatus.BAD_REQUEST,
    "request.media_type": HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
    "result.not_ready": HTTPStatus.NOT_FOUND,
    "route.not_found": HTTPStatus.NOT_FOUND,
    "server.busy": HTTPStatus.SERVICE_UNAVAILABLE,
    "server.not_ready": HTTPStatus.SERVICE_UNAVAILABLE,
    "storage.full": HTTPStatus.INSUFFICIENT_STORAGE,
    "storage.low": HTTPStatus.INSUFFICIENT_STORAGE,
    "upload.busy": HTTPStatus.LOCKED,
    "upload.elsewhere": HTTPStatus.CONFLICT,
    "upload.checksum_mismatch": CHECKSUM_MISMATCH,
    "upload.header_invalid": HTTPStatus.BAD_REQUEST,
    "upload.not_found": HTTPStatus.NOT_FOUND,
    "upload.too_large": HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
    "upload.version": HTTPStatus.PRECONDITION_FAILED,
}
OGC_TYPE_BY_CODE: dict[str, str] = {
    "job.not_found": OGC_EXCEPTIONS + "no-such-job",
    "process.not_found": OGC_EXCEPTIONS + "no-such-process",
    "result.not_ready": OGC_EXCEPTIONS + "result-not-ready",
}
_ALWAYS_RETRYABLE = {
    "idempotency.in_flight",
    "quota.jobs",
    "rate.exceeded",
    "result.not_ready",
    "server.busy",
    "server.not_ready",
    "upload.busy",
    "upload.elsewhere",
}


def status_of(code: str, fault: Fault) -> int:
    """The HTTP status of a failure."""
    return int(STATUS_BY_CODE.get(code, STATUS_BY_FAULT[fault]))


def problem_of(request: Request, error: IntegumentError) -> Problem:
    """The problem that tells the user of `error`."""
    return describe_problem(
        request,
        code=error.code,
        status=status_of(error.code, error.fault),
        detail=error.message,
        retryable=error.retryable or error.code in _ALWAYS_RETRYABLE,
        errors=error.violations if isinstance(error, ViolationsError) else (),
        facts=error.facts,
        findings=error.findings,
    )


def describe_problem(
    request: Request,
    *,
    code: str,
    status: int,
    detail: str,
    retryable: bool = False,
    errors: tuple[Violation, ...] = (),
    facts: dict[str, Fact] | None = None,
    findings: tuple[Finding, ...] = (),
) -> Problem:
    """A problem from its parts; type and title follow from the code. The code is left for the audit log."""
    request.scope.get(CODE_KEY, {})["code"] = code
    return Problem(
        type=OGC_TYPE_BY_CODE.get(code, f"urn:integument:problem:{code}"),
        title=code.replace(".", " ").replace("_", " ").capitalize(),
        status=status,
        detail=detail.encode("utf-8", "backslashreplace").decode(),  # what was sent may hold lone surrogates
        instance=request.url.path,
        code=code,
        request_id=request_id_of(request),
        retryable=retryable,
        errors=errors,
        facts={name: _sendable(fact) for name, fact in (facts or {}).items()},
        findings=findings,
    )


def _sendable(fact: Fact) -> Fact:
    """JSON has no NaN or infinity: such a number travels as its name."""
    return str(fact) if isinstance(fact, float) and not math.isfinite(fact) else fact


def problem_response(problem: Problem, headers: dict[str, str] | None = None) -> Response:
    """The HTTP answer that carries `problem`; never stored by caches."""
    return Response(
        problem.model_dump_json(),
        status_code=problem.status,
        headers={"Cache-Control": "no-store", **(headers or {})},
        media_type=MEDIA_TYPE,
    )
