"""Traces that nobody asked for cost nothing; tests/acceptance/test_seeing.py has those somebody did."""

from __future__ import annotations

import subprocess
import sys

import pytest

from core.errors import InternalError
from store.telemetry import ENDPOINTS, current_traceparent, span, start_telemetry, stop_telemetry


@pytest.fixture(autouse=True)
def _no_endpoint(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ENDPOINTS:
        monkeypatch.delenv(name, raising=False)


def test_without_an_endpoint_nothing_is_loaded() -> None:
    code = (
        "import sys\n"
        "from store.telemetry import *\n"
        "assert not start_telemetry('api')\n"
        "with span('a', parent='00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01') as one:\n"
        "    one.note(a__b=1); one.fail('x.y'); one.rename('b')\n"
        "    assert one.trace_id is None and current_traceparent() is None\n"
        "stop_telemetry()\n"
        "assert not [name for name in sys.modules if name.startswith('opentelemetry')]\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


def test_an_endpoint_without_the_packages_is_no_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ENDPOINTS[0], "http://127.0.0.1:9")
    monkeypatch.setitem(sys.modules, "opentelemetry.exporter.otlp.proto.http.trace_exporter", None)
    with pytest.raises(InternalError, match=r"integument-server\[telemetry\]") as caught:
        start_telemetry("api")
    assert caught.value.code == "telemetry.not_installed"


def test_what_comes_from_elsewhere_is_gone_on_with_unless_it_is_nonsense(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ENDPOINTS[0], "http://127.0.0.1:9")
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_TIMEOUT", "1")
    monkeypatch.setenv("OTEL_BSP_SCHEDULE_DELAY", "600000")
    monkeypatch.setenv("OTEL_TRACES_SAMPLER", "parentbased_always_off")  # nothing has to be sent
    assert start_telemetry("api")
    try:
        assert current_traceparent() is None
        with span("request", parent="00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-00") as outer:
            assert outer.trace_id == "4bf92f3577b34da6a3ce929d0e0e4736"
            carried = current_traceparent()
            assert carried is not None
            assert carried.startswith(f"00-{outer.trace_id}-")
            with span("inner", parent="00-11111111111111111111111111111111-1111111111111111-00") as inner:
                assert inner.trace_id == outer.trace_id, "the span around it comes first"
        for nonsense in ("", "x", "00-zz-zz-zz", "ü" * 500):
            with span("request", parent=nonsense) as alone:
                assert alone.trace_id not in (None, outer.trace_id)
    finally:
        stop_telemetry()
    assert current_traceparent() is None
