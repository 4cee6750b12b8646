"""Every failure leaves as a problem: ours, the framework's and the unexpected."""

from __future__ import annotations

import logging
from http import HTTPStatus

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response

from api.problems import describe_problem, problem_of, problem_response
from api.request_id import request_id_of
from api.schemas.problem import Problem
from api.violations import summarize, violations_of
from core.errors import IntegumentError

QUOTA_RETRY_S = 10  # jobs end when they end

logger = logging.getLogger(__name__)

_CODE_BY_FRAMEWORK_STATUS = {
    HTTPStatus.NOT_FOUND: "route.not_found",
    HTTPStatus.METHOD_NOT_ALLOWED: "method.not_allowed",
    HTTPStatus.REQUEST_ENTITY_TOO_LARGE: "request.too_large",
    HTTPStatus.REQUEST_TIMEOUT: "request.body_too_slow",
}


def install_problem_handlers(app: FastAPI) -> None:
    """Replace the framework's error answers by problems."""
    app.add_exception_handler(IntegumentError, _on_integument_error)
    app.add_exception_handler(RequestValidationError, _on_validation_error)
    app.add_exception_handler(HTTPException, _on_http_exception)


def on_unexpected(request: Request, error: Exception) -> Response:
    """The answer to a bug: nothing of the exception but its place in the log."""
    logger.error("request %s failed: %s %s", request_id_of(request), request.method, request.url.path, exc_info=error)
    return problem_response(
        describe_problem(
            request,
            code="internal.unexpected",
            status=HTTPStatus.INTERNAL_SERVER_ERROR,
            detail=f"The server failed in a way nobody foresaw. Its log tells more under request {request_id_of(request)}.",
            retryable=True,
        )
    )


async def _on_integument_error(request: Request, error: Exception) -> Response:
    if not isinstance(error, IntegumentError):
        raise error
    return answer_error(request, error)


def answer_error(request: Request, error: IntegumentError) -> Response:
    """The answer that tells of a failure of ours; internal ones go to the log, too."""
    problem = problem_of(request, error)
    if error.fault == "internal":
        logger.error("request %s failed: %s %s", problem.request_id, error.code, error.message, exc_info=error)
    return problem_response(problem, _headers_of(problem))


def _headers_of(problem: Problem) -> dict[str, str]:
    if problem.status == HTTPStatus.UNAUTHORIZED:
        error = "" if problem.code == "access.key_missing" else ', error="invalid_token"'
        return {"WWW-Authenticate": f'Bearer realm="integument"{error}'}
    if problem.status == HTTPStatus.FORBIDDEN and "needed" in problem.facts:
        return {"WWW-Authenticate": f'Bearer realm="integument", error="insufficient_scope", scope="{problem.facts["needed"]}"'}
    if problem.status == HTTPStatus.TOO_MANY_REQUESTS:
        return {"Retry-After": str(problem.facts.get("retry_after_s", QUOTA_RETRY_S))}
    if problem.status == HTTPStatus.SERVICE_UNAVAILABLE:
        return {"Retry-After": "1"}
    if problem.status == HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE:
        return {"Content-Range": f"bytes */{problem.facts['size']}"}
    return {}


async def _on_validation_error(request: Request, error: Exception) -> Response:
    if not isinstance(error, RequestValidationError):
        raise error
    listed = error.errors()
    if any(one["type"] == "json_invalid" for one in listed):
        detail = "; ".join(f"{one['ctx']['error']} at character {one['loc'][-1]}" for one in listed)
        code, status = "request.malformed", HTTPStatus.BAD_REQUEST
        return problem_response(describe_problem(request, code=code, status=status, detail=f"The body is not JSON: {detail}"))
    sent_type = request.headers.get("content-type", "none")
    if any(tuple(one["loc"]) == ("body",) for one in listed) and "json" not in sent_type:
        return problem_response(
            describe_problem(
                request,
                code="request.media_type",
                status=HTTPStatus.UNSUPPORTED_MEDIA_TYPE,
                detail=f"The body must be JSON with Content-Type application/json; it came with {sent_type[:100]}",
            )
        )
    violations = violations_of(listed)
    return problem_response(
        describe_problem(
            request,
            code="request.invalid",
            status=HTTPStatus.UNPROCESSABLE_ENTITY,
            detail=summarize(violations),
            errors=violations,
        )
    )


async def _on_http_exception(request: Request, error: Exception) -> Response:
    if not isinstance(error, HTTPException):
        raise error
    code = _CODE_BY_FRAMEWORK_STATUS.get(HTTPStatus(error.status_code), "request.malformed")
    detail = {
        "route.not_found": f"There is nothing at {request.url.path}",
        "method.not_allowed": f"{request.method} is not offered at {request.url.path}",
        "request.body_too_slow": "The body did not come to its end in time; send it in one go",
    }.get(code, str(error.detail))
    return problem_response(
        describe_problem(request, code=code, status=error.status_code, detail=detail), dict(error.headers or {})
    )
