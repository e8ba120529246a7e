"""The daemon's metrics in the text format of Prometheus."""

from collections.abc import Iterable, Iterator
from itertools import accumulate

from prometheus_client import CollectorRegistry, ProcessCollector, generate_latest
from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    InfoMetricFamily,
)
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.registry import Collector

import mocapd
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.pipeline.latency_histogram import BOUNDS_MS, LatencyCounts
from mocapd.service.health import lost_frames
from mocapd.service.readiness import READINESS_STATES, delivers, readiness_of
from mocapd.service.service import Snapshot
from mocapd.tracking.effort import Effort

MEDIA_TYPE = CONTENT_TYPE_LATEST

Families = Iterator[
    CounterMetricFamily | GaugeMetricFamily | HistogramMetricFamily | InfoMetricFamily
]


def metrics_text(snapshot: Snapshot | None) -> bytes:
    """The current metrics; None: nothing tracks, and only the process's metrics are served."""
    registry = CollectorRegistry(auto_describe=False)
    registry.register(_Collected(() if snapshot is None else tuple(_families(snapshot))))
    ProcessCollector(registry=registry)
    return generate_latest(registry)


class _Collected(Collector):
    def __init__(self, families: tuple[object, ...]) -> None:
        self._families = families

    def collect(self) -> Iterable[object]:  # type: ignore[override]
        """Called by the registry."""
        return self._families


def _families(snapshot: Snapshot) -> Families:
    metrics = snapshot.metrics
    yield InfoMetricFamily("mocapd", "This mocapd", {"version": mocapd.__version__})
    fitness = GaugeMetricFamily("mocapd_state", "1 for the state it is in", labels=["state"])
    now = readiness_of(snapshot)
    for one in READINESS_STATES:
        fitness.add_metric([one], float(one == now))
    yield fitness
    yield CounterMetricFamily(
        "mocapd_frames_published", "Skeleton frames published", metrics.published
    )
    yield CounterMetricFamily(
        "mocapd_frame_sets_dropped",
        "Sets of frames displaced by newer ones while the tracker was busy",
        metrics.sets_dropped,
    )
    effort = GaugeMetricFamily(
        "mocapd_effort", "1 for how much of its work the tracker does", labels=["effort"]
    )
    for level in Effort:
        effort.add_metric([level.value], float(level is metrics.effort))
    yield effort
    yield GaugeMetricFamily(
        "mocapd_publish_rate_hertz", "Skeleton frames a second, lately", metrics.rate_hz
    )
    yield _histogram(metrics.latency_counts)
    yield from _cameras(snapshot)
    yield from _outputs(snapshot)


def _histogram(latencies: LatencyCounts) -> HistogramMetricFamily:
    bounds = (*(f"{ms / 1e3:g}" for ms in BOUNDS_MS), "+Inf")
    return HistogramMetricFamily(
        "mocapd_latency_seconds",
        "From the exposure to after the last output",
        buckets=[*zip(bounds, accumulate(latencies.counts), strict=True)],
        sum_value=latencies.sum_ms / 1e3,
    )


def _cameras(snapshot: Snapshot) -> Families:
    up = GaugeMetricFamily("mocapd_camera_up", "1 while it delivers", labels=["camera"])
    rate = GaugeMetricFamily(
        "mocapd_camera_rate_hertz", "Pictures a second, lately", labels=["camera"]
    )
    frames = CounterMetricFamily("mocapd_camera_frames", "Pictures taken", labels=["camera"])
    lost = CounterMetricFamily(
        "mocapd_camera_lost_frames", "Pictures lost on the way, or damaged", labels=["camera"]
    )
    reopened = CounterMetricFamily(
        "mocapd_camera_reopened", "Times it was opened again", labels=["camera"]
    )
    bumped = GaugeMetricFamily(
        "mocapd_camera_bumped", "1 while it was turned since its calibration", labels=["camera"]
    )
    swapped = GaugeMetricFamily(
        "mocapd_camera_swapped", "1 while it shows what another camera should", labels=["camera"]
    )
    for name, status in snapshot.cameras.items():
        label, counted = [name], snapshot.metrics.cameras.get(name)
        up.add_metric(label, float(delivers(status)))
        rate.add_metric(label, status.fps_hz)
        frames.add_metric(label, status.frames)
        lost.add_metric(label, lost_frames(counted, status))
        reopened.add_metric(label, status.reopens)
        bumped.add_metric(label, float(snapshot.mountings.get(name) is Mounting.BUMPED))
        swapped.add_metric(label, float(snapshot.mountings.get(name) is Mounting.SWAPPED))
    yield from (up, rate, frames, lost, reopened, bumped, swapped)


def _outputs(snapshot: Snapshot) -> Families:
    sent = CounterMetricFamily("mocapd_output_sent", "Frames sent", labels=["output"])
    unsent = CounterMetricFamily(
        "mocapd_output_not_sent",
        "Frames that nobody listened to, that were refused, or that came too late",
        labels=["output"],
    )
    listeners = GaugeMetricFamily(
        "mocapd_output_listeners", "Programs that listen, where that can be told", labels=["output"]
    )
    for name, status in snapshot.outputs.items():
        sent.add_metric([name], status.sent)
        unsent.add_metric([name], status.refused)
        if status.listeners >= 0:
            listeners.add_metric([name], status.listeners)
    yield from (sent, unsent, listeners)
