"""Prometheus text: what was counted, what there is to do and who is there, all of it out of the database, so that every API
process tells the same; only event streams and `process_*` are of the process that answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import accumulate, product

from prometheus_client import CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric
from prometheus_client.registry import Collector
from prometheus_client.utils import floatToGoString

from api.services import Services
from core.schema.expectation import JobQueue
from core.schema.processes import PROCESSES
from store.callback import CallbackState
from store.job import JobStatus
from store.metric_family import FAMILIES, Family
from store.stored_bytes import MEASURED_AT, SET, STORED_BYTES
from store.tally import COUNT, SUM, Cell
from store.workers import Worker, WorkerState


def render_metrics(services: Services) -> str:
    """Text format 0.0.4. Raises InternalError `database.unavailable`."""
    services.http_tally.flush()
    registry = CollectorRegistry()
    registry.register(_Snapshot(services))
    ProcessCollector(registry=registry)
    return generate_latest(registry).decode()


class _Snapshot(Collector):
    """One scrape."""

    def __init__(self, services: Services) -> None:
        self._services = services

    def describe(self) -> Iterator[Metric]:
        """Nothing ahead of time: registering must not ask the database."""
        return iter(())

    def collect(self) -> Iterator[Metric]:
        """Everything but the process."""
        cells = self._services.metrics.read()
        yield from _backlog(self._services)
        yield from _presence(self._services.workers.list())
        yield from _stored(cells)
        for family in FAMILIES.values():
            yield _histogram(family, cells) if family.buckets else _counter(family, cells)


def _backlog(services: Services) -> Iterator[Metric]:
    count = services.backlog.count()
    jobs = GaugeMetricFamily("integument_jobs", "Jobs that wait or run.", labels=("process", "queue", "status"))
    for process in sorted({*PROCESSES, *(process for process, _, _ in count.jobs)}):
        for queue, status in product(JobQueue, (JobStatus.ACCEPTED, JobStatus.RUNNING)):
            jobs.add_metric((process, queue.value, status.value), count.jobs.get((process, queue, status), 0))
    yield jobs
    backlog = sum(count.jobs.values())
    yield GaugeMetricFamily("integument_backlog", "All jobs that wait or run: what to scale workers by.", value=backlog)
    text = "For how long the job that waits longest has been waiting; 0 if none waits."
    oldest = GaugeMetricFamily("integument_oldest_waiting_seconds", text, labels=("queue",))
    for queue, waiting_s in count.oldest_waiting_s.items():
        oldest.add_metric((queue.value,), waiting_s)
    yield oldest
    yield GaugeMetricFamily("integument_uploads_open", "Uploads in pieces under way.", value=count.uploads)
    callbacks = GaugeMetricFamily("integument_callbacks", "Callbacks to be sent, and those given up.", labels=("state",))
    told = services.callbacks.count()
    for state in (CallbackState.PENDING, CallbackState.DEAD):
        callbacks.add_metric((state.value,), told[state])
    yield callbacks
    yield GaugeMetricFamily("integument_event_streams", "Event streams this API process keeps open.", value=services.streams.open)


def _presence(workers: Sequence[Worker]) -> Iterator[Metric]:
    states = GaugeMetricFamily("integument_workers", "Workers by state; lost ones did not say goodbye.", labels=("state",))
    for state in WorkerState:
        states.add_metric((state.value,), sum(worker.state is state for worker in workers))
    yield states
    versions = GaugeMetricFamily("integument_worker_versions", "Workers that are there, by version.", labels=("version",))
    here = [worker for worker in workers if worker.state is not WorkerState.LOST]
    for version in sorted({worker.word.version for worker in here}):
        versions.add_metric((version,), sum(worker.word.version == version for worker in here))
    yield versions
    alive = [worker for worker in here if worker.state is WorkerState.ALIVE]
    slots = sum(worker.word.concurrency for worker in alive)
    yield GaugeMetricFamily("integument_worker_slots", "Jobs the workers that are there can run at a time.", value=slots)
    serving = GaugeMetricFamily(
        "integument_queue_workers", "Workers that take jobs of a queue; 0: its jobs wait.", labels=("queue",)
    )
    for queue in JobQueue:
        serving.add_metric((queue.value,), sum(queue in worker.word.queues for worker in alive))
    yield serving
    memory = sum(worker.word.memory_bytes for worker in alive)
    yield GaugeMetricFamily("integument_worker_memory_bytes", "Memory their jobs may use together.", value=memory)
    if here:
        silent_s = min(worker.silent_s for worker in here)
        yield GaugeMetricFamily("integument_worker_last_seen_seconds", "Since the last word of any worker.", value=silent_s)
        free = min(worker.word.disk_free_bytes for worker in here)
        yield GaugeMetricFamily("integument_worker_disk_free_bytes", "Where the fullest worker works.", value=free)


def _stored(cells: Mapping[Cell, float]) -> Iterator[Metric]:
    stored = GaugeMetricFamily(STORED_BYTES, "Bytes of uploads and outputs, as a worker last summed them up.", labels=("kind",))
    measured = GaugeMetricFamily(MEASURED_AT, "When that was.")
    for cell, value in sorted(cells.items(), key=lambda item: item[0].labels):
        if cell.cell == SET:
            (stored if cell.family == STORED_BYTES else measured).add_metric(cell.labels, value)
    yield stored
    yield measured


def _counter(family: Family, cells: Mapping[Cell, float]) -> Metric:
    metric = CounterMetricFamily(family.name.removesuffix("_total"), family.text, labels=family.labels)
    for labels in _series(family, cells):
        metric.add_metric(labels, cells.get(Cell(family.name, labels, COUNT), 0.0))
    return metric


def _histogram(family: Family, cells: Mapping[Cell, float]) -> Metric:
    metric = HistogramMetricFamily(family.name, family.text, labels=family.labels)
    bounds = [*map(floatToGoString, family.buckets), "+Inf"]
    for labels in _series(family, cells):
        counts = accumulate(cells.get(Cell(family.name, labels, str(number)), 0.0) for number in range(len(bounds)))
        metric.add_metric(labels, list(zip(bounds, counts, strict=True)), cells.get(Cell(family.name, labels, SUM), 0.0))
    return metric


def _series(family: Family, cells: Mapping[Cell, float]) -> list[tuple[str, ...]]:
    return sorted({cell.labels for cell in cells if cell.family == family.name})
