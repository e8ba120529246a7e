"""From any body to any other no joint jumps, and the way ends."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.skeleton import joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.trackers.supervisor.gliding import Away, Glider, Sourced, away_from, lessened, off
from mocapd.trackers.supervisor.params import Params
from mocapd.types import BodyState, Floats, Pose, Tracking
from tests.body.random_poses import pose_of, random_local, random_root

SKELETON = standard_skeleton(1.75)
STEP_M = 0.08
SEEDS = st.integers(0, 10_000)


def body(seed: int, spread_rad: float, aside_m: float = 0.0) -> Pose:
    root = random_root(seed) + (aside_m, 0.0, 0.0)
    return pose_of(SKELETON, root, random_local(seed, spread_rad))


def joints(pose: Pose) -> Floats:
    return joint_positions(SKELETON, pose)


def shown(known: Pose, away: Away | None) -> Pose:
    return known if away is None else off(known, away, away.share)


@settings(max_examples=60, deadline=None)
@given(SEEDS, SEEDS, st.floats(0.0, 3.0), st.floats(0.0, 2.0))
def test_a_body_at_rest_is_reached_without_a_jump(
    a: int, b: int, spread_rad: float, aside_m: float
) -> None:
    told, known = body(a, spread_rad), body(b, spread_rad, aside_m)
    away: Away | None = away_from(told, known)
    before = joints(told)
    assert np.allclose(joints(shown(known, away)), before, atol=1e-9)
    farthest_m = np.linalg.norm(before - joints(known), axis=1).max()
    frames = 0
    while away is not None:
        away = lessened(known, away, SKELETON, STEP_M)
        now = joints(shown(known, away))
        assert np.linalg.norm(now - before, axis=1).max() <= STEP_M + 1e-9
        before = now
        frames += 1
        assert frames < 200
    assert np.allclose(before, joints(known), atol=1e-9)
    assert frames >= np.floor(farthest_m / STEP_M)  # not faster than that is possible


@settings(max_examples=40, deadline=None)
@given(SEEDS, SEEDS, st.floats(0.0, 1.5), st.floats(0.0, 0.5))
def test_the_motion_itself_is_left_alone(a: int, b: int, spread_rad: float, aside_m: float) -> None:
    """Of a body that moves and turns as a whole, what is told moves and turns along, but for what is mended."""
    told, start = body(a, spread_rad), body(b, spread_rad, aside_m)
    away: Away | None = away_from(told, start)
    shift, turn = np.array([0.05, 0.01, -0.03]), rotations.exp(np.array([0.0, 0.05, 0.0]))
    known = start
    while away is not None:
        last = shown(known, away)
        moved = Pose(
            known.root_m + shift, rotations.canonical(rotations.multiply(turn, known.quats_xyzw))
        )
        carried = joints(off(moved, away, away.share))
        away = lessened(moved, away, SKELETON, STEP_M)
        beyond_m = np.linalg.norm(joints(shown(moved, away)) - carried, axis=1).max()
        assert beyond_m <= STEP_M + 1e-9
        # carried along: no farther than the body's own motion, twice where it is mirrored
        own_m = np.linalg.norm(joints(moved) - joints(known), axis=1).max()
        assert np.linalg.norm(carried - joints(last), axis=1).max() <= 2.0 * own_m + 0.1
        known = moved


def test_a_small_difference_is_gone_at_once() -> None:
    known = body(3, 0.5)
    told = Pose(known.root_m + (0.0, 0.05, 0.0), known.quats_xyzw)
    assert lessened(known, away_from(told, known), SKELETON, STEP_M) is None


def test_who_settles_on_the_way_does_not_jump_either() -> None:
    """By 8 cm in a frame, which is less than a way may take but not beside that."""
    aside_m = [0.0, 0.3, 0.3, 0.38, 0.38, 0.38, 0.38, 0.38, 0.38]
    glider, told_m = Glider(Params()), []
    for n, x_m in enumerate(aside_m):
        pose = Pose(body(3, 0.5).root_m + (x_m, 0.0, 0.0), body(3, 0.5).quats_xyzw)
        known = BodyState(
            n * 33_333_333, Tracking.LIVE, "one" if n == 0 else "other", pose, joints(pose), np.ones(len(joints(pose)))
        )  # fmt: skip
        told, _ = glider.step(Sourced(known, known.tracker), None, SKELETON)
        assert told.joints_m is not None
        told_m.append(told.joints_m)
    assert np.linalg.norm(np.diff(told_m, axis=0), axis=2).max() <= Params().glide_m + 1e-9
    assert np.allclose(told_m[-1], joints(pose))


def test_who_settles_while_they_run_does_not_stay_behind() -> None:
    """At 15 cm a frame, and by half of that elsewhere at first: what is told runs along while it is mended."""
    run_m = 0.15
    aside_m = [0.0, 0.25, 0.25, 0.31, 0.31, 0.31, 0.31, 0.31, 0.31]
    glider, off_m = Glider(Params()), []
    for n, x_m in enumerate(aside_m):
        pose = Pose(body(3, 0.5).root_m + (x_m, 0.0, n * run_m), body(3, 0.5).quats_xyzw)
        known = BodyState(
            n * 33_333_333, Tracking.LIVE, "one" if n == 0 else "other", pose, joints(pose), np.ones(len(joints(pose)))
        )  # fmt: skip
        was = None
        if n == 1:  # as the other one had it in the frame before
            there = Pose(pose.root_m - (0.0, 0.0, run_m), pose.quats_xyzw)
            was = Sourced(replace(known, t_ns=0, pose=there, joints_m=joints(there)), "other")
        told, _ = glider.step(Sourced(known, known.tracker), was, SKELETON)
        assert told.joints_m is not None
        off_m.append(told.joints_m - joints(Pose(pose.root_m - (x_m, 0.0, 0.0), pose.quats_xyzw)))
    steps_m = np.linalg.norm(np.diff(off_m, axis=0), axis=2)
    assert steps_m.max() <= Params().glide_m + 1e-9
    assert np.allclose(off_m[-1], [0.31, 0.0, 0.0])
