"""Prometheus text, counted in the database at the moment of asking: true for any number of API processes."""

from __future__ import annotations

from api.services import Services
from core.schema.processes import PROCESSES
from store.job import JobStatus


def render_metrics(services: Services) -> str:
    """Gauges only; a job that was removed is no longer counted."""
    count = services.backlog.count()
    callbacks = services.callbacks.count()
    jobs = {(process, status): 0 for process in PROCESSES for status in JobStatus} | dict(count.jobs)
    lines = [
        "# HELP integument_jobs Jobs in the table by process and status.",
        "# TYPE integument_jobs gauge",
        *(
            f'integument_jobs{{process="{process}",status="{status.value}"}} {number}'
            for (process, status), number in sorted(jobs.items())
        ),
        "# HELP integument_oldest_waiting_seconds For how long the job that waits longest has been waiting; 0 if none waits.",
        "# TYPE integument_oldest_waiting_seconds gauge",
        f"integument_oldest_waiting_seconds {count.oldest_waiting_s:.3f}",
        "# HELP integument_callbacks Callbacks in the table by state; dead ones were given up.",
        "# TYPE integument_callbacks gauge",
        *(f'integument_callbacks{{state="{state.value}"}} {number}' for state, number in sorted(callbacks.items())),
        "# HELP integument_event_streams Event streams this API process keeps open.",
        "# TYPE integument_event_streams gauge",
        f"integument_event_streams {services.streams.open}",
    ]
    return "\n".join(lines) + "\n"
