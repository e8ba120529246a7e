"""The figures of a benchmark as one JSON object, and as text tables."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from mocapd.evaluate.bench.bench_endurance import EnduranceFigures
from mocapd.evaluate.bench.bench_live import LiveFigures
from mocapd.evaluate.bench.bench_run import BenchResults
from mocapd.evaluate.bench.bench_step import StepFigures
from mocapd.evaluate.tables import number, table

_DIGITS = 3  # microseconds of a millisecond


def as_json(found: BenchResults) -> dict[str, Any]:
    """The figures by tracker, each with its `input`."""
    measured: Mapping[str, Any] = {**found.steps, **found.endurance, **found.live}
    figures = {name: {"input": found.recording, **asdict(f)} for name, f in measured.items()}
    rounded: dict[str, Any] = _round(figures)
    return rounded


def as_text(found: BenchResults) -> str:
    """Tables for a terminal that are also valid Markdown."""
    parts = [f"Input: {found.recording}"]
    if found.steps:
        parts.append(step_table(found.steps))
    for name, step in found.steps.items():
        if len(step.stages) > 1:
            parts += [f"Stages of {name}:", stage_table(step)]
    if found.endurance:
        parts.append(endurance_table(found.endurance))
    parts += [live_table(name, live) for name, live in found.live.items()]
    return "\n\n".join(parts)


def _round(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DIGITS)
    if isinstance(value, dict):
        return {key: _round(item) for key, item in value.items()}
    return [_round(item) for item in value] if isinstance(value, tuple) else value


def step_table(steps: Mapping[str, StepFigures]) -> str:
    """One row a tracker; times per frame set."""
    header = ("tracker", "sets", "median ms", "p95 ms", "mean ms", "CPU ms", "CPU mean ms",
              "RSS MB", "tracked %")  # fmt: skip
    rows = [
        (
            name, str(one.sets), number(one.median_ms, 2), number(one.p95_ms, 2),
            number(one.mean_ms, 2), number(one.cpu_ms, 2), number(one.cpu_mean_ms, 2),
            number(one.rss_mb, 0), number(100.0 * one.tracked, 1),
        )
        for name, one in steps.items()
    ]  # fmt: skip
    return table(header, rows)


def stage_table(step: StepFigures) -> str:
    """One row a stage; median and p95 over the sets in which it ran, the mean over all."""
    rows = [
        (
            name, number(one.median_ms, 2), number(one.p95_ms, 2), number(one.mean_ms, 2),
            number(100.0 * one.share, 0),
        )
        for name, one in step.stages.items()
    ]  # fmt: skip
    return table(("stage", "median ms", "p95 ms", "mean ms", "ran in % of sets"), rows)


def endurance_table(endurance: Mapping[str, EnduranceFigures]) -> str:
    """One row a quarter of each run, and the trend of memory."""
    rows = []
    for name, one in endurance.items():
        what = f"{name}, {one.minutes:.1f} min, {one.sets} sets"
        columns = zip(one.median_ms, one.p95_ms, one.cpu_ms, one.rss_mb, strict=False)
        for i, (*times_ms, rss) in enumerate(columns, start=1):
            cells = (*(number(value, 2) for value in times_ms), number(rss, 0))
            rows.append((f"{what}, quarter {i}", *cells))
        trend = f"{number(one.rss_slope_mb_per_min, 2)} MB/min"
        rows.append((f"{what}, trend", "", "", "", trend))
    return table(("run", "median ms", "p95 ms", "CPU ms", "RSS MB"), rows)


def live_table(name: str, live: LiveFigures) -> str:
    """One row a figure."""
    rows = (
        ("frames published per second", number(live.rate_hz, 2)),
        ("frame sets dropped, %", number(100.0 * live.dropped, 2)),
        ("frames that did not reach the subscriber, %", number(100.0 * live.missing, 2)),
        ("frames with evidence of every camera, %", number(100.0 * live.all_cameras, 1)),
        ("frames tracked live, %", number(100.0 * live.live, 1)),
        ("capture to publish, median ms", number(live.latency_median_ms, 1)),
        ("capture to publish, p95 ms", number(live.latency_p95_ms, 1)),
        ("capture to arrival, median ms", number(live.arrival_median_ms, 1)),
        ("capture to arrival, p95 ms", number(live.arrival_p95_ms, 1)),
        ("processor, cores", number(live.cpu_share, 2)),
        ("processor per frame set, ms", number(live.cpu_ms, 1)),
        ("resident memory, MB", number(live.rss_mb, 0)),
        ("trend of memory, MB/min", number(live.rss_slope_mb_per_min, 2)),
        ("start to first published frame, s", number(live.start_s, 2)),
        ("pictures of the page per second", number(live.pictures_per_s, 1)),
    )
    return table((f"{name}, live for {live.seconds:.0f} s", ""), rows)
