"""The rig's mailbox: pairs on arrival, hands out the newest set, wakes at deadlines."""

import threading

import pytest

from mocapd.pipeline.collector import FrameCollector
from tests.pipeline.free_running import MS, PERIOD_NS, frame


class HandClock:
    """A clock that the test sets."""

    def __init__(self) -> None:
        self.now_ns = 0

    def __call__(self) -> int:
        return self.now_ns


def test_the_newest_pair_is_handed_out_whole_and_the_displaced_counted() -> None:
    clock = HandClock()
    collector = FrameCollector(("a", "b"), clock=clock)
    for k in range(4):
        for name, offset in (("a", 0), ("b", 11 * MS)):
            clock.now_ns = k * PERIOD_NS + offset + 20 * MS
            collector.put(frame(name, k, k * PERIOD_NS + offset))
    newest = collector.get(0.0)
    assert newest is not None
    assert [f.seq for f in newest.frames.values()] == [3, 3]
    assert collector.get(0.0) is None
    counts = collector.counts()
    assert (counts.sets, counts.dropped) == (4, 3)
    assert counts.rates_hz["a"] == pytest.approx(30.0, abs=0.1)


def test_a_missing_frame_is_waited_for_until_the_deadline() -> None:
    clock = HandClock()
    collector = FrameCollector(("a", "b"), clock=clock)
    collector.put(frame("a", 0, 0))
    assert collector.get(0.0) is None
    clock.now_ns = 2 * PERIOD_NS
    alone = collector.get(0.0)
    assert alone is not None
    assert list(alone.frames) == ["a"]


def test_the_waiting_thread_wakes_when_a_deadline_passes_without_any_frame() -> None:
    collector = FrameCollector(("a", "b"))  # on the real clock
    got: list[object] = []
    reader = threading.Thread(target=lambda: got.append(collector.get(30.0)))
    reader.start()
    collector.put(frame("a", 0, 0))
    reader.join(20.0)
    assert len(got) == 1
    assert got[0] is not None


def test_a_waiting_thread_wakes_when_the_pair_is_whole() -> None:
    clock = HandClock()
    collector = FrameCollector(("a", "b"), clock=clock)
    got: list[object] = []
    reader = threading.Thread(target=lambda: got.append(collector.get(30.0)))
    reader.start()
    collector.put(frame("a", 0, 0))
    collector.put(frame("b", 0, 1 * MS))
    reader.join(20.0)
    assert len(got) == 1
    assert got[0] is not None


def test_close_wakes_and_refuses() -> None:
    collector = FrameCollector(("a",))
    got: list[object] = []
    reader = threading.Thread(target=lambda: got.append(collector.get()))
    reader.start()
    collector.close()
    reader.join(10.0)
    collector.put(frame("a", 0, 0))
    assert got == [None]
    assert collector.get() is None
    assert collector.closed
    assert collector.counts().sets == 0


def test_frames_of_many_threads_are_all_accounted_for() -> None:
    names = ("a", "b", "c")
    collector = FrameCollector(names)
    n = 300

    def feed(name: str) -> None:
        for k in range(n):
            collector.put(frame(name, k, k * PERIOD_NS))

    feeders = [threading.Thread(target=feed, args=(name,)) for name in names]
    for feeder in feeders:
        feeder.start()
    for feeder in feeders:
        feeder.join(30.0)
    taken = 0
    while collector.get(0.2) is not None:
        taken += 1
    counts = collector.counts()
    assert counts.sets == taken + counts.dropped
    for count in counts.cameras.values():
        assert count.received == n
        assert count.received == count.used + count.late
