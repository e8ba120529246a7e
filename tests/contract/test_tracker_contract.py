"""Each promise of mocapd.tracking.base.Tracker, on every registered tracker."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.body.shape import skeleton_of
from mocapd.body.skeleton import joint_positions
from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.errors import ConfigError
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.trackers.registry import TRACKERS, Resources, build
from mocapd.tracking.base import EffortTracker, LearningTracker, Track, no_probe
from mocapd.tracking.effort import Effort
from mocapd.types import BodyState, FrameSet, Tracking
from tests.contract.tracker_cases import CASES, PERIOD_NS, TrackerCase
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

DAY_NS = 86_400_000_000_000


@pytest.fixture(scope="module", params=list(TRACKERS))
def built(request: pytest.FixtureRequest, smaller_database: PoseDatabase) -> TrackerCase:
    assert request.param in CASES, "add its case to tests/contract/tracker_cases.py"
    return CASES[request.param](smaller_database)


@dataclass(frozen=True)
class Tracked:
    """The first run over the person's frames after a reset. Several tests compare another run with it.

    stages: those heard of; written: whether a frame differed afterwards; half: a copy of the body of the last
    frame of the first half, made before the second.
    """

    tracks: list[Track]
    stages: list[str]
    written: bool
    half: BodyState


@pytest.fixture(scope="module")
def tracked(built: TrackerCase) -> Tracked:
    frames = [f for one in built.person for f in one.frames.values()]
    before = [f.pixels.copy() for f in frames]
    stages: list[str] = []
    built.tracker.reset()
    built.tracker.tracker.probe = stages.append
    halfway = built.half
    tracks = run(built.tracker, built.person[:halfway])
    half = copied(tracks[-1].body)
    tracks += run(built.tracker, built.person[halfway:])
    built.tracker.tracker.probe = no_probe
    written = any(not np.array_equal(b, f.pixels) for b, f in zip(before, frames, strict=True))
    return Tracked(tracks, stages, written, half)


@pytest.fixture
def case(built: TrackerCase) -> TrackerCase:
    """Built once, since that may be slow; as new in each test, by the promise of `reset`."""
    built.tracker.reset()
    return built


def run(
    tracker: Stepping, sets: Sequence[FrameSet], after: Callable[[], None] = lambda: None
) -> list[Track]:
    tracks = []
    for one in sets:
        tracks.append(tracker.step(one))
        after()
    return tracks


def copied(body: BodyState) -> BodyState:
    """With arrays of its own."""
    out = replace(body, confidence=body.confidence.copy(), uncertainty_m=body.uncertainty_m.copy())
    if body.pose is None or body.joints_m is None:
        return out
    pose = replace(
        body.pose, root_m=body.pose.root_m.copy(), quats_xyzw=body.pose.quats_xyzw.copy()
    )
    return replace(out, pose=pose, joints_m=body.joints_m.copy())


def assert_same(one: BodyState, other: BodyState) -> None:
    assert (one.t_ns, one.tracking, one.tracker) == (other.t_ns, other.tracking, other.tracker)
    assert one.cameras == other.cameras
    assert np.array_equal(one.confidence, other.confidence)
    assert np.array_equal(one.uncertainty_m, other.uncertainty_m)
    if one.pose is None or other.pose is None:
        assert one.pose is other.pose
        return
    assert np.array_equal(one.pose.root_m, other.pose.root_m)
    assert np.array_equal(one.pose.quats_xyzw, other.pose.quats_xyzw)
    assert one.joints_m is not None
    assert other.joints_m is not None
    assert np.array_equal(one.joints_m, other.joints_m)


def assert_carried(case: TrackerCase, body: BodyState) -> None:
    """A body says which cues carry it; nobody, or a body of a tracker without cues, who looked."""
    lost = body.tracking is Tracking.LOST
    assert body.tracker in ((case.tracker.name,) if lost else case.carriers or (case.tracker.name,))


def assert_well_formed(case: TrackerCase, track: Track, frames: FrameSet) -> None:
    body = track.body
    n = len(case.tracker.skeleton.names)
    assert body.t_ns == frames.t_ns
    assert_carried(case, body)
    assert set(body.cameras) <= set(frames.frames)
    assert body.confidence.shape == (n,)
    assert ((body.confidence >= 0.0) & (body.confidence <= 1.0)).all()
    assert body.uncertainty_m.shape == (n,)
    assert (body.uncertainty_m > 0.0).all()
    assert 0.0 <= track.quality <= 1.0
    if body.tracking is Tracking.LOST:
        assert track.quality == 0.0
        assert body.pose is None
        assert body.joints_m is None
        assert not body.confidence.any()
        assert np.isinf(body.uncertainty_m).all()
        return
    assert body.pose is not None
    assert body.joints_m is not None
    assert body.pose.root_m.shape == (3,)
    assert body.pose.quats_xyzw.shape == (n, 4)
    assert np.isfinite(body.joints_m).all()
    assert np.allclose(np.linalg.norm(body.pose.quats_xyzw, axis=1), 1.0, atol=1e-9)
    assert (body.pose.quats_xyzw[:, 3] >= 0.0).all()
    expected = joint_positions(skeleton_of(track.shape), body.pose)
    assert np.allclose(body.joints_m, expected, atol=1e-6)
    for camera, evidence in track.evidence.items():
        x0, y0, x1, y1 = track.roi_px[camera]
        assert evidence.dtype == np.uint8
        assert 0 <= x0 <= x1
        assert 0 <= y0 <= y1


def test_names_agree(case: TrackerCase) -> None:
    assert case.tracker.name in TRACKERS
    assert case.tracker.skeleton.names == NAMES


def test_it_tracks_a_person_and_all_it_says_is_well_formed(
    case: TrackerCase, tracked: Tracked
) -> None:
    for one, track in zip(case.person, tracked.tracks, strict=True):
        assert_well_formed(case, track, one)
    assert track.body.tracking is Tracking.LIVE
    assert track.body.cameras
    assert track.quality > 0.3


def test_it_goes_on_from_another_trackers_body_at_once(case: TrackerCase, tracked: Tracked) -> None:
    """Without the frames in which a person who comes is not believed yet, and without a jump."""
    half = case.half
    tracks = tracked.tracks
    assert tracks[0].body.tracking is not Tracking.LIVE or not TRACKERS[case.tracker.name].sees
    before = tracks[half - 1].body
    case.tracker.reset(near=replace(before, tracker="another"))
    for there, again in zip(tracks[half:], run(case.tracker, case.person[half:]), strict=True):
        assert again.body.tracking is Tracking.LIVE
        assert_carried(case, again.body)
        assert there.body.joints_m is not None
        assert again.body.joints_m is not None
        seen = there.body.confidence > 0.0  # legs that nobody sees are anywhere
        apart_m = np.linalg.norm(again.body.joints_m - there.body.joints_m, axis=1)[seen]
        assert np.sqrt((apart_m**2).mean()) < 0.1


def test_a_body_that_the_pictures_do_not_confirm_is_not_believed(
    case: TrackerCase, tracked: Tracked
) -> None:
    if not TRACKERS[case.tracker.name].sees:
        return
    body = tracked.tracks[-1].body
    case.tracker.reset(near=replace(body, t_ns=case.empty[0].t_ns - 1, tracker="another"))
    assert all(t.body.tracking is not Tracking.LIVE for t in run(case.tracker, case.empty))


def test_the_shape_is_its_owners(case: TrackerCase) -> None:
    """Bones are as long as those of the shape that is handed in, also of measured proportions."""
    run(case.tracker, case.person[:6])
    factors = case.tracker.shape.factors.copy()
    factors[2] = 1.1  # upper arms
    case.tracker.shape = replace(case.tracker.shape, factors=factors)
    track = case.tracker.step(case.person[6])
    assert_well_formed(case, track, case.person[6])
    assert abs(track.shape.factors[2] - 1.1) < 0.05


def test_what_it_lacks_is_said_before_it_is_built(case: TrackerCase) -> None:
    name, one = case.tracker.name, TRACKERS[case.tracker.name]
    blind = Calibration(wearer=Wearer(1.7))
    assert bool(one.lacks(blind, ("left",))) == one.sees
    if one.sees:
        with pytest.raises(ConfigError, match=name):
            build(name, blind, Resources())


def test_each_stage_of_a_step_is_heard_of(case: TrackerCase, tracked: Tracked) -> None:
    assert bool(tracked.stages) == TRACKERS[case.tracker.name].sees


def test_with_the_least_effort_a_person_is_tracked_the_same_each_time(
    case: TrackerCase, tracked: Tracked
) -> None:
    tracker = case.tracker.tracker
    if not isinstance(tracker, EffortTracker):
        pytest.skip("it leaves nothing out")
    tracker.set_effort(Effort.LEAST)
    runs = []
    for _ in range(2):
        case.tracker.reset()
        runs.append(run(case.tracker, case.person))
    tracker.set_effort(Effort.FULL)
    for one, other in zip(*runs, strict=True):
        assert_same(one.body, other.body)
    assert runs[0][-1].body.tracking is Tracking.LIVE
    case.tracker.reset()
    for again, before in zip(run(case.tracker, case.person), tracked.tracks, strict=True):
        assert_same(again.body, before.body)


def test_what_was_handed_out_does_not_change_afterwards(
    built: TrackerCase, tracked: Tracked
) -> None:
    assert_same(tracked.tracks[built.half - 1].body, tracked.half)


def test_frames_are_not_written_to(case: TrackerCase, tracked: Tracked) -> None:
    assert not any(f.pixels.flags.writeable for one in case.person for f in one.frames.values())
    assert not tracked.written


def test_without_any_frame_ever_it_is_lost(case: TrackerCase) -> None:
    assert case.tracker.step(FrameSet(0, {})).body.tracking is Tracking.LOST


def test_in_an_empty_room_nobody_is_found(case: TrackerCase) -> None:
    sees = TRACKERS[case.tracker.name].sees
    for one, track in zip(case.empty, run(case.tracker, case.empty), strict=True):
        assert_well_formed(case, track, one)
        if sees:
            assert track.body.tracking is Tracking.LOST


def test_time_is_only_what_frames_say_and_a_pause_or_a_missing_camera_is_no_error(
    case: TrackerCase, tracked: Tracked
) -> None:
    """The same pictures a whole number of days later after a reset: the same states, at the frames' times, whether or
    not the tracker learns between its steps. The next day it goes on. Then the first camera goes missing, and when it is
    back the last one; and without any camera the person is lost."""
    tracker = case.tracker.tracker
    learn = tracker.learn if isinstance(tracker, LearningTracker) else lambda: None
    later = run(case.tracker, [shifted(one, DAY_NS) for one in case.person], learn)
    for one, other in zip(tracked.tracks, later, strict=True):
        assert_same(one.body, replace(other.body, t_ns=other.body.t_ns - DAY_NS))
    for frames in [shifted(one, 2 * DAY_NS) for one in case.person]:
        track = case.tracker.step(frames)
        assert_well_formed(case, track, frames)
    assert track.body.tracking is Tracking.LIVE
    half, n = case.half, len(case.person)
    for k, missing in enumerate((0, -1), start=1):
        for seen in case.person[half:]:
            again = shifted(seen, 2 * DAY_NS + k * (n - half) * PERIOD_NS)
            gone = [*again.frames][missing]
            there = {name: frame for name, frame in again.frames.items() if name != gone}
            t_ns = next(iter(there.values())).t_ns if there else again.t_ns
            frames = FrameSet(t_ns, there)
            assert_well_formed(case, case.tracker.step(frames), frames)
    for k in range(1, 91):
        nothing = FrameSet(frames.t_ns + k * PERIOD_NS, {})
        track = case.tracker.step(nothing)
        assert_well_formed(case, track, nothing)
    assert track.body.tracking is Tracking.LOST


def shifted(one: FrameSet, by_ns: int) -> FrameSet:
    frames = {name: replace(frame, t_ns=frame.t_ns + by_ns) for name, frame in one.frames.items()}
    return FrameSet(one.t_ns + by_ns, frames, one.spread_ns)


def test_an_unknown_tracker_is_an_error_that_names_the_known() -> None:
    with pytest.raises(ConfigError, match=", ".join(TRACKERS)):
        build("psychic", Calibration(), Resources())


def test_canned_needs_no_compiler_and_no_camera_library() -> None:
    code = (
        "import sys\n"
        "from mocapd.calibration.calibration_record import Calibration, Wearer\n"
        "from mocapd.trackers.registry import Resources, build\n"
        "build('canned', Calibration(wearer=Wearer(1.7)), Resources())\n"
        "print(sorted({'numba', 'cv2', 'scipy'} & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.strip() == "[]"
