"""Garbage of a daemon whose tracker is too slow for its frame sets, for hours."""

import time
import weakref
from collections.abc import Callable

import pytest

from mocapd.pipeline import idle_collection
from mocapd.tracking.effort import Effort
from tests.pipeline.test_loop import Run, SlowTracker


class AlwaysSlow(SlowTracker):
    """Too slow at any effort."""

    def set_effort(self, effort: Effort) -> None: ...


class Node:
    """Garbage that only a collection frees."""

    def __init__(self) -> None:
        self.me = self


def test_without_any_idle_moment_garbage_is_collected_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in ("YOUNG_EVERY_NS", "ALL_EVERY_NS", "OVERDUE_NS"):
        monkeypatch.setattr(idle_collection, name, 100_000_000)
    tracker = AlwaysSlow()
    run = Run(tracker)
    tracker.sets = lambda: run.collector.sets
    run.loop.start()

    def feed_until(condition: Callable[[], bool]) -> None:
        until_s = time.monotonic() + 60.0
        while not condition() and time.monotonic() < until_s:
            run.feed()
            time.sleep(0.002)

    feed_until(lambda: bool(run.out))  # what was there before it began is never collected
    held = weakref.ref(Node())
    feed_until(lambda: held() is None)
    tracker.effort = Effort.LEAST  # lets the last step end
    assert run.loop.stop(20.0)
    assert held() is None
