"""A match as a player meets it: calibration, countdown, clock, pauses, score, replay, the next round."""

from dataclasses import replace

import numpy as np
import pytest

from goalkeeper.core.difficulty import STEP_DOWN, STEP_UP, Difficulty
from goalkeeper.core.events import Conceded, Counted, Event, Kicked, Paused, RoundOver, Saved
from goalkeeper.core.flight import straight_flight
from goalkeeper.core.limbs import INDEX, POINTS, LimbPose, Part, pose_of_joints
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.core.pitch import GOAL_LINE_Z_M, TICK_HZ, TICK_S
from goalkeeper.core.reach import Reach, is_t_pose
from goalkeeper.core.scoring import Score
from goalkeeper.core.shots import RandomShooter, Shot
from mocapd.body.bones import NAMES
from mocapd.body.skeleton import standard_skeleton
from mocapd.types import Floats

REST_M = standard_skeleton(1.75).rest_m


def t_pose(yaw_rad: float = 0.0, at_m: tuple[float, float] = (0.0, 0.0)) -> LimbPose:
    """Somebody who makes a T somewhere in the room."""
    c, s = np.cos(yaw_rad), np.sin(yaw_rad)
    turned = REST_M @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    joints_m = (turned + [at_m[0], 0.0, at_m[1]]).tolist()
    pose = pose_of_joints(dict(zip(NAMES, joints_m, strict=True)))
    assert pose is not None
    return pose


class AimedShooter:
    """Shoots at one place, again and again."""

    def __init__(self, *targets_m: tuple[float, float]) -> None:
        self.targets_m = targets_m

    def watch(self, t_s: float, pose: LimbPose | None) -> None: ...

    def next_shot(self, number: int, now_s: float, difficulty: Difficulty, reach: Reach) -> Shot:
        x_m, y_m = self.targets_m[number % len(self.targets_m)]
        target_m = np.array([x_m, y_m, GOAL_LINE_Z_M])
        flight = straight_flight(np.array([x_m, 0.105, 9.0]), target_m, 0.7, 0.0)
        return Shot(number, now_s + 0.8, flight, target_m, "straight")


AT_HAND, AT_GOAL = (0.78, 1.42), (1.2, 0.3)


def play(match: Match, pose: LimbPose | None, seconds: float) -> list[Event]:
    """So long, with the keeper in one pose."""
    return [event for _ in range(round(seconds * TICK_HZ)) for event in match.tick(pose)]


def phase_of(match: Match) -> Phase:
    """Now."""
    return match.phase


def playing(*targets_m: tuple[float, float], **rules: float | int | bool | None) -> Match:
    """A match that has just begun to be played."""
    match = Match(replace(MatchRules(), **rules), AimedShooter(*targets_m))  # type: ignore[arg-type]
    play(match, t_pose(), 0.7 + 3.1)
    assert phase_of(match) is Phase.PLAYING
    return match


def test_reach_and_place_are_measured_from_a_t_pose_turned_and_off_the_middle() -> None:
    match = Match(MatchRules(), AimedShooter(AT_HAND))
    play(match, t_pose(yaw_rad=0.5, at_m=(0.4, -0.3)), 1.0)
    assert phase_of(match) is Phase.COUNTDOWN
    assert match.reach.yaw_rad == pytest.approx(0.5, abs=0.01)
    tip_m = t_pose().point("leftTip")
    assert match.reach.side_m == pytest.approx(tip_m[0], abs=0.03)
    moment = match.moment()
    assert moment is not None
    # before the goal he faces the balls, left hand to +X
    assert moment.pose.point("leftTip") == pytest.approx(tip_m, abs=0.03)
    assert moment.pose.point("leftToes")[2] > moment.pose.point("leftFoot")[2]


def test_arms_that_hang_are_no_t_pose() -> None:
    pose = t_pose()
    points_m = pose.points_m.copy()
    points_m[INDEX["leftHand"]] = points_m[INDEX["leftUpperArm"]] - [0.0, 0.5, 0.0]
    assert is_t_pose(pose)
    assert not is_t_pose(LimbPose(points_m, pose.known))


def test_the_countdown_counts_three_two_one_go() -> None:
    match = Match(MatchRules(), AimedShooter(AT_HAND))
    numbers = [e.number for e in play(match, t_pose(), 4.0) if isinstance(e, Counted)]
    assert numbers == [3, 2, 1, 0]


def test_a_ball_at_the_hand_is_saved_and_one_beside_it_is_not() -> None:
    match = playing(AT_HAND, AT_GOAL)
    events = play(match, t_pose(), 4.0)
    first, second = (e for e in events if isinstance(e, Saved | Conceded))
    assert isinstance(first, Saved)
    assert isinstance(second, Conceded)
    assert (match.score.saves, match.score.goals, match.score.streak) == (1, 1, 0)
    assert match.score.points == first.points > 0


def test_a_saved_ball_flies_away_from_the_goal() -> None:
    match = playing(AT_HAND)
    while not any(isinstance(e, Saved) for e in match.tick(t_pose())):
        pass
    assert match.ball is not None
    z_m = match.ball.position_m[2]
    play(match, t_pose(), 0.3)
    assert match.ball.position_m[2] > z_m + 0.2


def test_the_clock_stands_while_the_player_is_lost_and_the_ball_in_the_air_does_not_count() -> None:
    match = playing(AT_GOAL)
    assert any(isinstance(e, Kicked) for e in play(match, t_pose(), 1.0))
    left_s = match.left_s
    paused = [e for e in play(match, None, 5.0) if isinstance(e, Paused)]
    assert [e.reason for e in paused] == ["tracking lost: step back into view"]
    assert phase_of(match) is Phase.PAUSED
    assert match.left_s == pytest.approx(left_s, abs=2 * TICK_S)
    play(match, t_pose(), 0.35 + 3.05)
    assert phase_of(match) is Phase.PLAYING
    assert match.score == Score()


def test_a_player_who_pauses_is_waited_for_even_when_seen() -> None:
    match = playing(AT_GOAL)
    match.toggle_pause()
    play(match, t_pose(), 10.0)
    assert phase_of(match) is Phase.PAUSED
    match.toggle_pause()
    play(match, t_pose(), 3.1)
    assert phase_of(match) is Phase.PLAYING


def test_a_round_lasts_two_minutes_then_shows_its_best_save_four_times_slower() -> None:
    match = playing(AT_HAND)
    events = play(match, t_pose(), 119.0)
    assert not any(isinstance(e, RoundOver) for e in events)
    events = []
    while phase_of(match) is Phase.PLAYING:
        events += match.tick(t_pose())
    assert sum(isinstance(e, RoundOver) for e in events) == 1
    assert match.left_s == 0.0
    assert phase_of(match) is Phase.REPLAY
    clip = match.best_clip
    assert clip is not None
    assert len(clip.moments) * TICK_S > 1.0
    # the ball is at the hand at the contact
    at = clip.moments[clip.contact]
    assert np.linalg.norm(at.ball_m - at.pose.point("leftHand")) < 0.35
    ticks = 0
    while phase_of(match) is Phase.REPLAY:
        match.tick(t_pose())
        ticks += 1
    assert 3 * len(clip.moments) < ticks <= 4 * len(clip.moments)
    match.next_round()
    assert phase_of(match) is Phase.COUNTDOWN
    assert match.score == Score()


def test_hands_beat_the_trunk_fast_balls_slow_ones_and_streaks_multiply() -> None:
    score = Score()
    assert (
        score.worth(Part.HAND, 20.0) > score.worth(Part.HAND, 10.0) > score.worth(Part.BODY, 10.0)
    )
    for _ in range(3):
        score = score.with_save(Part.HAND, 10.0)
    assert (score.multiplier, score.points) == (2, 300)
    assert score.with_goal().multiplier == 1
    assert score.with_goal().best_streak == 3


def test_difficulty_settles_where_seven_of_ten_are_saved() -> None:
    assert pytest.approx(0.3 * STEP_DOWN) == 0.7 * STEP_UP
    rng = np.random.default_rng(0)
    difficulty = Difficulty(0.0)
    levels = []
    for _ in range(2000):  # a player who saves fewer the harder it is, seven of ten at 0.6
        difficulty = difficulty.after(rng.random() < 1.0 - 0.5 * difficulty.level)
        levels.append(difficulty.level)
    assert np.mean(levels[200:]) == pytest.approx(0.6, abs=0.08)


def test_shots_are_the_same_for_the_same_seed_and_always_on_target() -> None:
    reach = Reach(0.86, 2.15, (0.0, 0.0), 0.0)

    def drawn(seed: int) -> list[Floats]:
        shooter = RandomShooter(seed)
        shots = [shooter.next_shot(i, 0.0, Difficulty(i / 200), reach) for i in range(200)]
        for shot in shots:
            at_m = shot.flight.at(shot.flight.duration_s)
            assert at_m == pytest.approx(shot.target_m)
            assert abs(at_m[0]) < 1.5 - 0.105
            assert 0.105 <= at_m[1] < 2.0 - 0.105
            times = np.linspace(0.0, shot.flight.duration_s, 200)
            assert min(shot.flight.at(t)[1] for t in times) > 0.104
        return [shot.target_m for shot in shots]

    assert np.array_equal(drawn(7), drawn(7))
    assert not np.array_equal(drawn(7), drawn(8))


def test_a_pose_needs_hips_and_chest_and_numbers() -> None:
    joints = dict(zip(NAMES, REST_M.tolist(), strict=True))
    assert pose_of_joints({}) is None
    assert pose_of_joints({k: v for k, v in joints.items() if k != "hips"}) is None
    for bad in (float("nan"), float("inf"), 1e9):
        pose = pose_of_joints(joints | {"leftHand": [0.0, bad, 0.0]})
        assert pose is not None
        assert np.isfinite(pose.points_m).all()
        unknown = {name for name, known in zip(POINTS, pose.known, strict=True) if not known}
        assert unknown == {"leftHand", "leftTip"}
