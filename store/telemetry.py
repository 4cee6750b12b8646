"""Traces by OpenTelemetry, if `OTEL_EXPORTER_OTLP_ENDPOINT` (or `..._TRACES_ENDPOINT`) says where to; else nothing is loaded.

One trace per request: what the API does, and through the trace id in the job's row what a worker does, stage by stage. The other
`OTEL_*` variables (headers, sampler, service name) mean what OpenTelemetry says they mean."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from core.errors import InternalError

if TYPE_CHECKING:
    from opentelemetry.sdk.trace import TracerProvider
    from opentelemetry.trace import Span as OtelSpan

ENDPOINTS = ("OTEL_EXPORTER_OTLP_ENDPOINT", "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT")
INSTALL = "pip install 'integument-server[telemetry]'"

_provider: TracerProvider | None = None


class Span:
    """Something that takes time; does nothing where traces are off."""

    def __init__(self, told: OtelSpan | None = None) -> None:
        self._told = told

    @property
    def trace_id(self) -> str | None:
        """32 hex digits."""
        return None if self._told is None else f"{self._told.get_span_context().trace_id:032x}"

    def rename(self, name: str) -> None:
        """Once it is known better."""
        if self._told is not None:
            self._told.update_name(name)

    def note(self, **facts: Any) -> None:
        """Attributes; `__` in a name stands for the dot. None is left out."""
        if self._told is not None:
            self._told.set_attributes({name.replace("__", "."): fact for name, fact in facts.items() if fact is not None})

    def fail(self, code: str) -> None:
        """It ended with this error."""
        if self._told is not None:
            from opentelemetry.trace import StatusCode

            self._told.set_status(StatusCode.ERROR, code)
            self.note(error__type=code)


def start_telemetry(part: str) -> bool:
    """For the main program of `api` or `worker`; False where no endpoint is named.

    Raises InternalError `telemetry.not_installed`: traces somebody asked for are not left out in silence."""
    global _provider
    if not any(os.environ.get(name) for name in ENDPOINTS):
        return False
    try:
        from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
        from opentelemetry.sdk.resources import Resource
        from opentelemetry.sdk.trace import TracerProvider
        from opentelemetry.sdk.trace.export import BatchSpanProcessor
    except ImportError as error:
        raise InternalError(
            "telemetry.not_installed", f"{ENDPOINTS[0]} is set, but OpenTelemetry is missing: {INSTALL}"
        ) from error
    _provider = TracerProvider(resource=Resource.create({"service.name": f"integument-{part}"}), shutdown_on_exit=False)
    _provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    return True


def stop_telemetry() -> None:
    """Send what waits."""
    global _provider
    if _provider is not None:
        _provider.shutdown()
        _provider = None


@contextmanager
def span(name: str, *, parent: str | None = None, server: bool = False) -> Iterator[Span]:
    """Below the span around it in this thread or task, else below `parent`, a traceparent that came from elsewhere."""
    if _provider is None:
        yield Span()
        return
    from opentelemetry.trace import SpanKind, get_current_span
    from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator

    around = None
    if parent is not None and not get_current_span().get_span_context().is_valid:
        around = TraceContextTextMapPropagator().extract({"traceparent": parent})
    tracer = _provider.get_tracer("integument")
    kind = SpanKind.SERVER if server else SpanKind.INTERNAL
    with tracer.start_as_current_span(name, context=around, kind=kind, record_exception=False) as told:
        yield Span(told)


def current_traceparent() -> str | None:
    """Of the span around the caller, in the form of the W3C; None without one."""
    if _provider is None:
        return None
    from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator

    carrier: dict[str, str] = {}
    TraceContextTextMapPropagator().inject(carrier)
    return carrier.get("traceparent")
