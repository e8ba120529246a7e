"""Pairing by time: nearest partners, no longer a wait than needed, nothing lost silently."""

from collections.abc import Mapping
from itertools import chain, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.errors import ConfigError
from mocapd.pipeline.bundler import Bundler, BundlerParams
from mocapd.types import Frame, FrameSet
from tests.pipeline.free_running import MS, PERIOD_NS, FreeRunning, Released, frame, run_live

SECOND = 1_000 * MS
HALF = PERIOD_NS // 2


def names_of(released: list[Released]) -> list[tuple[str, ...]]:
    return [tuple(r.frames.frames) for r in released]


@pytest.mark.parametrize("phase_ms", [0, 3, 11, 16, 22, 30])
@pytest.mark.parametrize("delay_b_ms", [20, 5, 45])
def test_two_cameras_pair_with_the_nearest_frame_and_wait_for_it_only(
    phase_ms: int, delay_b_ms: int
) -> None:
    cameras = [
        FreeRunning("a", jitter_ns=MS // 2),
        FreeRunning("b", phase_ms * MS, jitter_ns=MS // 2, delay_ns=delay_b_ms * MS),
    ]
    released = run_live(Bundler(("a", "b"), None), cameras, 3 * SECOND)[12:-2]
    nearest = min(phase_ms * MS, PERIOD_NS - phase_ms * MS)
    assert set(names_of(released)) == {("a", "b")}
    for r in released:
        assert r.frames.t_ns == max(f.t_ns for f in r.frames.frames.values())
        assert r.frames.spread_ns <= nearest + MS
        assert r.at_ns == r.complete_ns  # the moment its last frame arrived


def test_eleven_milliseconds_apart_pairs_forward_and_each_keeps_its_own_time() -> None:
    bundler = Bundler(("a", "b"))
    out: list[FrameSet] = []
    for k in range(5):
        t_ns = k * PERIOD_NS
        assert bundler.add(frame("a", k, t_ns), t_ns + 20 * MS) == ()
        out += bundler.add(frame("b", k, t_ns + 11 * MS), t_ns + 31 * MS)
    assert [s.spread_ns for s in out] == [11 * MS] * 5
    assert out[3].t_ns == out[3].frames["b"].t_ns  # the freshest instant
    assert out[3].t_ns - out[3].frames["a"].t_ns == 11 * MS


def test_a_set_is_never_timed_before_the_one_already_out() -> None:
    bundler = Bundler(("a", "b", "fast"))
    out: list[FrameSet] = []
    for k in range(8):
        t_ns = k * PERIOD_NS
        arriving = [("a", k, t_ns), ("fast", 2 * k, t_ns + MS), ("fast", 2 * k + 1, t_ns + 12 * MS)]
        for name, seq, at_ns in (*arriving, ("b", k, t_ns + 15 * MS)):
            out += bundler.add(frame(name, seq, at_ns), t_ns + 20 * MS)
    pairs = list(pairwise(out))
    assert any(later.t_ns == earlier.t_ns + 1 for earlier, later in pairs)
    assert all(later.t_ns > earlier.t_ns for earlier, later in pairs)


@pytest.mark.parametrize("order", [("near", "far"), ("far", "near")])
def test_a_camera_that_always_comes_too_late_holds_nobody_up(order: tuple[str, str]) -> None:
    """A network camera beside a webcam: its frames are never in time, so a wait for them is in vain."""
    cameras = [
        FreeRunning("near", jitter_ns=MS, delay_ns=10 * MS),
        FreeRunning("far", 5 * MS, jitter_ns=MS, delay_ns=100 * MS),
    ]
    released = run_live(Bundler(order), cameras, 3 * SECOND)[12:-4]
    assert set(names_of(released)) == {("near",)}
    assert all(r.at_ns == r.complete_ns for r in released)


def test_a_lost_frame_delays_its_set_by_about_a_period_and_no_other() -> None:
    cameras = [
        FreeRunning("a"),
        FreeRunning("b", 11 * MS, dead=(1 * SECOND, 1 * SECOND + PERIOD_NS)),
    ]
    bundler = Bundler(("a", "b"))
    released = run_live(bundler, cameras, 2 * SECOND)[2:-1]
    alone = [r for r in released if len(r.frames.frames) == 1]
    assert len(alone) == 1
    assert alone[0].at_ns - alone[0].complete_ns <= PERIOD_NS
    assert all(r.at_ns == r.complete_ns for r in released if r is not alone[0])
    assert bundler.counts()["b"].lost == 1


@pytest.mark.parametrize("dead", ["a", "b"])
def test_a_dying_camera_holds_two_sets_at_most_and_is_paired_again_at_once(dead: str) -> None:
    gap = (1 * SECOND, 2 * SECOND)
    cameras = [
        FreeRunning("a", dead=gap if dead == "a" else (0, 0)),
        FreeRunning("b", 11 * MS, dead=gap if dead == "b" else (0, 0)),
    ]
    bundler = Bundler(("a", "b"))
    released = run_live(bundler, cameras, 3 * SECOND)
    held = [r for r in released[1:-1] if r.at_ns > r.complete_ns]
    assert len(held) <= 2
    assert all(r.at_ns - r.complete_ns <= 1.5 * PERIOD_NS for r in held)
    alone = [r for r in released[1:-1] if len(r.frames.frames) == 1]
    assert len(alone) == pytest.approx(30, abs=2)
    back = [r for r in released if r.frames.t_ns > 2 * SECOND + 2 * PERIOD_NS]
    assert {len(r.frames.frames) for r in back[:-1]} == {2}


def test_a_camera_that_never_comes_is_waited_for_twice() -> None:
    released = run_live(Bundler(("ghost", "a")), [FreeRunning("a")], SECOND)
    held = [r for r in released if r.at_ns > r.complete_ns]
    assert len(released) == 30
    assert len(held) <= 3  # the third came while the second waited
    assert held[-1].frames.t_ns <= 2 * PERIOD_NS


def test_a_camera_at_half_the_rate_holds_nobody_up() -> None:
    cameras = [FreeRunning("slow", period_ns=2 * PERIOD_NS), FreeRunning("fast", 8 * MS)]
    released = run_live(Bundler(("slow", "fast")), cameras, 2 * SECOND)[10:-2]
    assert all(r.at_ns == r.complete_ns for r in released)
    assert names_of(released).count(("slow", "fast")) == pytest.approx(len(released) / 2, abs=1)
    assert max(r.frames.spread_ns for r in released) <= 8 * MS


def test_half_a_period_apart_with_jitter_keeps_its_partners() -> None:
    cameras = [FreeRunning("a", jitter_ns=2 * MS), FreeRunning("b", HALF, jitter_ns=2 * MS)]
    released = run_live(Bundler(("a", "b")), cameras, 10 * SECOND)
    alone = [r for r in released[2:-2] if len(r.frames.frames) == 1]
    assert len(alone) <= 3
    limit = (0.5 + BundlerParams().hysteresis_periods) * PERIOD_NS
    assert max(r.frames.spread_ns for r in released) <= limit + MS


def test_drifting_cameras_change_partners_once_a_beat() -> None:
    cameras = [FreeRunning("a"), FreeRunning("b", period_ns=PERIOD_NS + 100_000, jitter_ns=MS)]
    released = run_live(Bundler(("a", "b")), cameras, 22 * SECOND)  # two beats of 11.1 s
    alone = [r for r in released[2:-2] if len(r.frames.frames) == 1]
    assert len(alone) <= 4


def test_a_late_frame_is_counted_and_not_used() -> None:
    bundler = Bundler(("a", "b"))
    out: list[FrameSet] = []
    for k in range(10):
        t_ns = k * PERIOD_NS
        out += bundler.add(frame("a", k, t_ns), t_ns)
        if k != 8:
            out += bundler.add(frame("b", k, t_ns + 2 * MS), t_ns + 2 * MS)
    deadline = bundler.deadline_ns
    late_ns = 8 * PERIOD_NS + 2 * MS
    bundler.add(frame("b", 10, 10 * PERIOD_NS), 10 * PERIOD_NS)
    assert deadline is None  # set 8 left when frame 9 of b arrived
    before = bundler.counts()["b"].late
    bundler.add(frame("b", 8, late_ns), 11 * PERIOD_NS)
    assert bundler.counts()["b"].late == before + 1


def late_by(late_ns: int, params: BundlerParams) -> tuple[list[tuple[str, ...]], int]:
    """One frame of "b" comes so late: the names of its set, and how long after its first frame's arrival
    the set went out [ns]."""
    bundler = Bundler(("a", "b"), params)
    for k in range(10):
        for name in ("a", "b"):
            bundler.add(frame(name, k, k * PERIOD_NS), k * PERIOD_NS + 20 * MS)
    t_ns = 10 * PERIOD_NS
    arrival_ns = t_ns + 20 * MS
    assert bundler.add(frame("a", 10, t_ns), arrival_ns) == ()
    until_ns = bundler.deadline_ns
    assert until_ns is not None
    if arrival_ns + late_ns < until_ns:
        sets = bundler.add(frame("b", 10, t_ns), arrival_ns + late_ns)
        return [tuple(s.frames) for s in sets], late_ns
    return [tuple(s.frames) for s in bundler.flush(until_ns)], until_ns - arrival_ns


def test_a_camera_with_a_wait_of_its_own_is_waited_for_so_long_and_no_longer() -> None:
    own = BundlerParams(camera_waits_s={"b": 0.1})
    assert late_by(80 * MS, BundlerParams()) == ([("a",)], PERIOD_NS // 2)
    assert late_by(80 * MS, own) == ([("a", "b")], 80 * MS)
    assert late_by(100 * MS, own) == ([("a",)], 100 * MS)


def test_a_camera_that_is_not_worth_a_wait_keeps_nobody_waiting() -> None:
    bundler = Bundler(("a", "b"), BundlerParams(camera_waits_s={"b": 0.0}))
    assert [tuple(s.frames) for s in bundler.add(frame("a", 0, 0), 20 * MS)] == [("a",)]


def test_the_wait_of_one_camera_is_not_that_of_the_others() -> None:
    own = BundlerParams(camera_waits_s={"a": 0.1})
    assert late_by(80 * MS, own) == late_by(80 * MS, BundlerParams())


def test_a_constant_offset_between_capture_times_and_now_does_not_matter() -> None:
    cameras = [FreeRunning("a", delay_ns=10**15), FreeRunning("b", 9 * MS, delay_ns=10**15)]
    released = run_live(Bundler(("a", "b")), cameras, 2 * SECOND)[1:-1]
    assert all(r.at_ns == r.complete_ns and len(r.frames.frames) == 2 for r in released)


def test_a_reopened_camera_may_count_from_zero_again() -> None:
    bundler = Bundler(("a",))
    for k, t in ((5, 0), (6, PERIOD_NS), (0, 3 * SECOND), (1, 3 * SECOND + PERIOD_NS)):
        assert len(bundler.add(frame("a", k, t))) == 1
    assert bundler.counts()["a"].lost == 0


camera = st.builds(
    FreeRunning,
    name=st.just(""),
    phase_ns=st.integers(0, PERIOD_NS),
    period_ns=st.sampled_from([PERIOD_NS, PERIOD_NS + 40_000, 2 * PERIOD_NS, PERIOD_NS // 2]),
    jitter_ns=st.integers(0, 4 * MS),
    delay_ns=st.integers(0, 60 * MS),
    drop=st.sampled_from([0.0, 0.05, 0.5]),
    dead=st.sampled_from([(0, 0), (300 * MS, 800 * MS), (0, 500 * MS), (700 * MS, 9 * SECOND)]),
)


waits_s = st.dictionaries(
    st.sampled_from(["cam0", "cam2"]), st.sampled_from([0.0, 0.03, 0.2]), max_size=2
)


@given(st.lists(camera, min_size=1, max_size=4), waits_s, st.integers(0, 2**32 - 1))
def test_whatever_the_cameras_do(
    rough: list[FreeRunning], waits_s: dict[str, float], seed: int
) -> None:
    cameras = [
        FreeRunning(f"cam{i}", c.phase_ns, c.period_ns, c.jitter_ns, c.delay_ns, c.drop, c.dead)
        for i, c in enumerate(rough)
    ]
    bundler = Bundler([c.name for c in cameras], BundlerParams(camera_waits_s=waits_s))
    released = run_live(bundler, cameras, int(1.5 * SECOND), seed)
    sets = [r.frames for r in released]

    times = [s.t_ns for s in sets]
    assert times == sorted(set(times))  # strictly increasing
    used = [(f.camera, f.seq) for s in sets for f in s.frames.values()]
    assert len(used) == len(set(used))  # no frame twice
    for name, count in bundler.counts().items():
        assert count.used == sum(1 for n, _ in used if n == name)
        assert count.received == count.used + count.late  # nothing lost silently
    for r in released:
        s = r.frames
        order = [n for n in (c.name for c in cameras) if n in s.frames]
        assert list(s.frames) == order
        assert s.t_ns >= max(f.t_ns for f in s.frames.values())
        assert s.spread_ns == max(abs(f.t_ns - s.t_ns) for f in s.frames.values())
        assert s.spread_ns <= 2 * 0.65 * (2 * PERIOD_NS + 4 * MS)  # both sides of the anchor
        assert all(f.camera == name for name, f in s.frames.items())
        longest = BundlerParams().longest_wait_periods * (2 * PERIOD_NS + 4 * MS)
        longest = max(longest, *(s * SECOND for s in (0.0, *waits_s.values())))
        assert r.at_ns - r.complete_ns <= longest or r.at_ns == int(1.5 * SECOND)


def bundled(streams: Mapping[str, list[Frame]]) -> list[FrameSet]:
    """The frame sets of recorded streams, added in order of capture."""
    bundler, sets = Bundler(streams), list[FrameSet]()
    for one in sorted(chain(*streams.values()), key=lambda f: f.t_ns):
        sets += bundler.add(one)
    return [*sets, *bundler.finish()]


@given(st.integers(0, PERIOD_NS), st.sampled_from([0.0, 0.1]), st.integers(0, 99))
def test_recordings_give_every_frame_and_the_same_sets_each_time(
    phase_ns: int, drop: float, seed: int
) -> None:
    def recorded() -> list[tuple[int, tuple[tuple[str, int], ...]]]:
        rng = np.random.default_rng(seed)
        streams = {
            c.name: [f for _, f in c.arrivals(SECOND, rng)]
            for c in (FreeRunning("a", drop=drop), FreeRunning("b", phase_ns, drop=drop))
        }
        sets = bundled(streams)
        in_all = sum(len(frames) for frames in streams.values())
        assert in_all - sum(len(s.frames) for s in sets) <= 1 + round(drop * 10)
        return [(s.t_ns, tuple((f.camera, f.seq) for f in s.frames.values())) for s in sets]

    assert recorded() == recorded()


def test_recordings_in_step_use_every_frame() -> None:
    streams = {
        name: [frame(name, k, offset + k * PERIOD_NS) for k in range(60)]
        for name, offset in (("a", 0), ("b", 10_500_000), ("c", 0))
    }
    sets = bundled(streams)
    assert len(sets) == 60
    assert all(len(s.frames) == 3 for s in sets)


def test_an_unknown_camera_is_refused() -> None:
    with pytest.raises(KeyError):
        Bundler(("a",)).add(frame("b", 0, 0))
    with pytest.raises(ConfigError):
        Bundler(())
