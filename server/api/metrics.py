"""`/metrics`: the service's state as Prometheus reads it, looked up when it is asked for."""

from __future__ import annotations

import logging
from collections.abc import Iterator

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import PlainTextResponse
from prometheus_client import CollectorRegistry, ProcessCollector
from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    InfoMetricFamily,
    Metric,
    StateSetMetricFamily,
)
from prometheus_client.exposition import CONTENT_TYPE_LATEST, generate_latest
from prometheus_client.registry import Collector

from server.api.services import Services, ServicesDep
from server.mission.feed import Subscriber
from server.mission.pace import LATENESS_BOUNDS, Pace
from server.pages.scene_proxy import Traffic, traffic
from server.published import MissionSnapshot
from server.versions import becalm_version
from sim.control.phases import Phase

log = logging.getLogger(__name__)

router = APIRouter(include_in_schema=False)

STATUSES = ("preparing", "ok", "faulted")


@router.get("/metrics")
async def metrics(services: ServicesDep, request: Request) -> PlainTextResponse:
    """Of this moment, in Prometheus's text format."""
    watching, lost = services.feed.subscribers, services.feed.lost  # they live in this event loop
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    registry.register(ServiceState(services, watching, lost, traffic(request)))
    return PlainTextResponse(await run_in_threadpool(generate_latest, registry), media_type=CONTENT_TYPE_LATEST)


class ServiceState(Collector):
    """What the service is doing, at one moment."""

    def __init__(self, services: Services, watching: tuple[Subscriber, ...], lost: int, scenes: Traffic) -> None:
        self._services = services
        self._scenes = scenes
        self._watching = watching
        self._lost = lost

    def collect(self) -> Iterator[Metric]:
        """Every family of metrics."""
        services = self._services
        info = {"version": becalm_version(), "plant": services.settings.plant}
        yield InfoMetricFamily("becalm", "The service that answers", info)
        status = {each: each == services.loop.status for each in STATUSES}
        yield StateSetMetricFamily("becalm_status", "Whether there is a mission to command", status)
        yield from _clock(services.loop.pace)
        if services.loop.tick_age is not None:
            yield _gauge("becalm_tick_age_seconds", "Since the last tick was flown", services.loop.tick_age)
        if services.link is not None and (age := services.link.age()) is not None:
            yield _gauge("becalm_link_age_seconds", "Since the robot was last heard of", age)
        if services.feed.latest is not None:
            yield from _mission(services.feed.latest.snapshot)
        yield self._queues()
        yield from self._clients()
        yield from self._storage()
        yield from self._runs()

    def _queues(self) -> Metric:
        services = self._services
        family = GaugeMetricFamily("becalm_queue_depth", "What waits in a queue of the service", labels=["queue"])
        for queue, depth in {
            "commands": services.loop.waiting,
            "runs": services.scripted.waiting,
            "studies": services.study_queue.waiting,
            "audit": services.access.audit.waiting,
            "telemetry": max((watcher.waiting for watcher in self._watching), default=0),
        }.items():
            family.add_metric([queue], depth)
        return family

    def _clients(self) -> Iterator[Metric]:
        yield _gauge("becalm_telemetry_clients", "Who watches the telemetry", len(self._watching))
        yield CounterMetricFamily("becalm_telemetry_lost_frames", "Frames dropped for slow clients", self._lost)

        yield _gauge("becalm_scene_clients", "Sockets of scenes that are open", self._scenes.open)
        text = "Messages of browsers to scenes that were none of a camera, and not passed on"
        yield CounterMetricFamily("becalm_scene_dropped_messages", text, self._scenes.dropped)

    def _storage(self) -> Iterator[Metric]:
        recorder, disk = self._services.recorder, self._services.disk
        yield _gauge("becalm_recorder_lag_seconds", "How long the oldest tick in memory may have waited", recorder.lag)
        yield _gauge("becalm_recorder_backlog_bytes", "Ticks that wait for the disk", recorder.backlog)
        yield _gauge("becalm_recorder_failed", "1: the live run is not being recorded", recorder.failure is not None)
        if disk.free is not None:
            yield _gauge("becalm_disk_free_bytes", "Free space where the runs lie", disk.free)

    def _runs(self) -> Iterator[Metric]:
        """Nothing of a library that is gone, but for that."""
        labels = ["kind", "status", "outcome"]
        family = GaugeMetricFamily("becalm_runs", "Runs in the library; outcome is empty without one", labels=labels)
        try:
            tally, unreadable = self._services.index.tally(), self._services.index.unreadable()
        except OSError as error:
            log.warning("the library of runs cannot be counted: %s", error)
            yield _gauge("becalm_library_readable", "1: the library of runs can be read", 0)
            return
        for (kind, status, outcome), count in tally.items():
            family.add_metric([kind, status, outcome or ""], count)
        yield family
        yield _gauge("becalm_library_readable", "1: the library of runs can be read", 1)
        yield _gauge("becalm_runs_unreadable", "Folders in the library that cannot be read", len(unreadable))


def _clock(pace: Pace) -> Iterator[Metric]:
    total, buckets = 0, []
    for bound, count in zip((*map(str, LATENESS_BOUNDS), "+Inf"), pace.lateness_counts, strict=True):
        total += count
        buckets.append((bound, float(total)))
    text = "How late the oldest tick of a turn was"
    yield HistogramMetricFamily("becalm_tick_lateness_seconds", text, buckets, pace.lateness_sum)
    yield CounterMetricFamily("becalm_clock_slips", "Times that the schedule was given up and restarted", pace.slips)


def _mission(snapshot: MissionSnapshot) -> Iterator[Metric]:
    phase = {each.label: each.label == snapshot.phase for each in Phase}
    yield StateSetMetricFamily("becalm_phase", "Of the live mission", phase)
    yield _gauge("becalm_mission_time_seconds", "Of the live mission", snapshot.time)
    factor = snapshot.plant.real_time_factor
    yield _gauge("becalm_real_time_factor", "Mission time flown in the last second", factor)
    yield _gauge("becalm_worst_tick_lateness_seconds", "In the last second", snapshot.plant.lateness)
    problems = GaugeMetricFamily("becalm_problems", "Problems shown to the operator", labels=["severity"])
    for severity in ("warning", "error"):
        problems.add_metric([severity], sum(each.severity == severity for each in snapshot.problems))
    yield problems


def _gauge(name: str, text: str, value: float) -> Metric:
    return GaugeMetricFamily(name, text, value)
