"""One match: phases, clock, shots and score, a tick at a time. Pure: the same poses give the same match."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from goalkeeper.core.ball import Outcome, ShotBall
from goalkeeper.core.clip import SLOWNESS, Clip, ClipRecorder, Moment, merit_of_save
from goalkeeper.core.difficulty import START_LEVEL, Difficulty
from goalkeeper.core.events import (
    Conceded,
    Counted,
    Event,
    Kicked,
    Paused,
    ReachFound,
    RoundOver,
    Saved,
)
from goalkeeper.core.limbs import LIMBS, LimbPose
from goalkeeper.core.pitch import TICK_S
from goalkeeper.core.reach import USUAL_REACH, Reach, ReachFinder, reach_of
from goalkeeper.core.scoring import Score
from goalkeeper.core.shots import Shooter, Shot

LOST = "tracking lost: step back into view"
ASKED = "paused"
_BACK_S = 0.3  # how long the player is seen again before the countdown
_LOOSE_S = 1.2  # how long a ball is shown after its shot ended
_NO_BALL = np.array([0.0, -10.0, 0.0])  # below the ground
_WIND_UP_S = 0.5  # a shot is known so long before it is launched, at most: the shooter's run-up


class Phase(StrEnum):
    """What goes on."""

    CALIBRATING = "calibrating"
    COUNTDOWN = "countdown"
    PLAYING = "playing"
    PAUSED = "paused"
    REPLAY = "replay"
    OVER = "over"


@dataclass(frozen=True, slots=True)
class MatchRules:
    """round_s: play in a round [s]; countdown_s; replay: whether the best save is shown at its end; calibrate_s: how
    long a T-pose is waited for [s], None: for ever; shots: end after so many, None: by time; level: of the first."""

    round_s: float = 120.0
    countdown_s: float = 3.0
    replay: bool = True
    calibrate_s: float | None = None
    shots: int | None = None
    level: float = START_LEVEL


class Match:
    """Call `tick` 120 times a second with the keeper's pose in the world; read the rest."""

    def __init__(self, rules: MatchRules, shooter: Shooter, reach: Reach | None = None) -> None:
        """reach: of an earlier calibration, which is then not done again."""
        self.rules, self._shooter = rules, shooter
        self.phase = Phase.CALIBRATING
        self.reach = reach or USUAL_REACH
        self.pause_reason = ""
        self.finder = ReachFinder()
        self._ticks = self._phase_ticks = self._seen_ticks = 0
        self._known: LimbPose | None = None  # the newest pose, before the goal
        self._begin_round()
        if reach is not None:
            self._enter(Phase.COUNTDOWN)

    def _begin_round(self) -> None:
        self.score = Score()
        self.difficulty = Difficulty(self.rules.level)
        self.ball: ShotBall | None = None
        self.shot: Shot | None = None  # that comes next
        self._clips = ClipRecorder()
        self._play_ticks = self._shots = 0

    # -- what is shown -----------------------------------------------------------------------------

    @property
    def t_s(self) -> float:
        """The match's clock, which never stands [s]."""
        return self._ticks * TICK_S

    @property
    def is_seen(self) -> bool:
        """Whether somebody is seen at this tick."""
        return self._seen_ticks > 0

    @property
    def left_s(self) -> float:
        """Of the round [s]."""
        return max(0.0, self.rules.round_s - self._play_ticks * TICK_S)

    @property
    def counted(self) -> int:
        """What the countdown shows."""
        return int(self.rules.countdown_s - self._phase_ticks * TICK_S + 0.999)

    @property
    def best_clip(self) -> Clip | None:
        """The best save of this round, until now."""
        return self._clips.best

    @property
    def wind_up(self) -> float:
        """How much of the run-up before the next shot is done, 0..1."""
        if self.shot is None:
            return 0.0
        return min(max(1.0 - (self.shot.launch_s - self.t_s) / _WIND_UP_S, 0.0), 1.0)

    @property
    def replay_progress(self) -> float:
        """How much of the replay has passed, 0..1."""
        clip = self._clips.best
        return 1.0 if clip is None else min(self._phase_ticks / SLOWNESS / len(clip.moments), 1.0)

    def moment(self) -> Moment | None:
        """Keeper and ball as they are to be seen now, a ball far below the ground when there is none; None: nobody."""
        if self.phase is Phase.REPLAY and self._clips.best is not None:
            return self._clips.best.at(self._phase_ticks / SLOWNESS)
        if self._known is None:
            return None
        ball_m = self.ball.position_m if self.ball is not None else _NO_BALL
        return Moment(self._known, ball_m)

    # -- what the player wants ---------------------------------------------------------------------

    def toggle_pause(self) -> None:
        """Pause, or go on."""
        if self.phase in (Phase.PLAYING, Phase.COUNTDOWN):
            self._pause(ASKED)
        elif self.phase is Phase.PAUSED:
            self._enter(Phase.COUNTDOWN)

    def set_level(self, level: float) -> None:
        """From the next shot on; 0..1."""
        self.rules = replace(self.rules, level=level)
        self.difficulty = Difficulty(level)

    def recalibrate(self) -> None:
        """Measure the reach anew, and begin a round."""
        self._begin_round()
        self.finder = ReachFinder()
        self._enter(Phase.CALIBRATING)

    def next_round(self) -> None:
        """Begin another round; before the end of one nothing."""
        if self.phase in (Phase.OVER, Phase.REPLAY):
            self._begin_round()
            self._enter(Phase.COUNTDOWN)

    # -- a tick ------------------------------------------------------------------------------------

    def tick(self, pose: LimbPose | None) -> list[Event]:
        """1/120 s further; pose: of the keeper in the world, None: lost."""
        self._ticks += 1
        self._phase_ticks += 1
        self._shooter.watch(self.t_s, pose)
        before = self._known
        self._seen_ticks = 0 if pose is None else self._seen_ticks + 1
        if pose is not None:
            self._known = self.reach.placed(pose)
        match self.phase:
            case Phase.CALIBRATING:
                return self._calibrate(pose)
            case Phase.COUNTDOWN:
                return self._count_down(pose)
            case Phase.PLAYING:
                return self._play(before, pose)
            case Phase.PAUSED:
                if self.pause_reason == LOST and self._seen_ticks * TICK_S >= _BACK_S:
                    self._enter(Phase.COUNTDOWN)
            case Phase.REPLAY:
                clip = self._clips.best
                if clip is None or self._phase_ticks / SLOWNESS >= len(clip.moments):
                    self._enter(Phase.OVER)
            case Phase.OVER:
                pass
        return []

    def _calibrate(self, pose: LimbPose | None) -> list[Event]:
        found = self.finder.step(pose, TICK_S)
        limit_s = self.rules.calibrate_s
        if found is None and limit_s is not None and self._phase_ticks * TICK_S >= limit_s:
            found = USUAL_REACH if pose is None else reach_of(pose)
        if found is None:
            return []
        self.reach = found
        self._enter(Phase.COUNTDOWN)
        return [ReachFound(found)]

    def _count_down(self, pose: LimbPose | None) -> list[Event]:
        if pose is None:
            return self._pause(LOST)
        if self._phase_ticks == 1:
            return [Counted(self.counted)]
        now_s, last_s = self._phase_ticks * TICK_S, (self._phase_ticks - 1) * TICK_S
        if now_s >= self.rules.countdown_s:
            self._enter(Phase.PLAYING)
            return [Counted(0)]
        return [Counted(self.counted)] if int(now_s) != int(last_s) else []

    def _play(self, before: LimbPose | None, pose: LimbPose | None) -> list[Event]:
        if pose is None or self._known is None:
            return self._pause(LOST)
        self._play_ticks += 1
        events: list[Event] = []
        if self.ball is not None:
            outcome = self.ball.step(before or self._known, self._known)
            self._clips.saw(self._known, self.ball.position_m)
            if outcome is not None:
                events += self._ended(self.ball.shot, outcome)
        if self.ball is not None and self.ball.outcome is None:
            return events
        if not self._limit_reached():
            return [*events, *self._shoot()]
        if self.ball is None or self.ball.since_outcome_s >= _LOOSE_S:
            events += self._end_round()
        return events

    def _shoot(self) -> list[Event]:
        """The next shot, once the last one has ended."""
        if self.shot is None:
            self.shot = self._shooter.next_shot(self._shots, self.t_s, self.difficulty, self.reach)
        if self.t_s < self.shot.launch_s:
            return []
        self.ball, shot = ShotBall(self.shot), self.shot
        self.shot = None
        self._shots += 1
        self._clips.begin_shot()
        return [Kicked(shot)]

    def _ended(self, shot: Shot, outcome: Outcome) -> list[Event]:
        self.difficulty = self.difficulty.after(outcome.saved)
        if not outcome.saved:
            self.score = self.score.with_goal()
            return [Conceded(shot, outcome)]
        part = LIMBS[outcome.limb].part
        points = self.score.worth(part, outcome.speed_mps)
        self.score = self.score.with_save(part, outcome.speed_mps)
        if self._known is not None:
            self._clips.saved(merit_of_save(self._known, outcome.place_m, outcome.speed_mps))
        return [Saved(shot, outcome, points, self.score.streak)]

    def _limit_reached(self) -> bool:
        if self.rules.shots is not None:
            return self._shots >= self.rules.shots
        return self._play_ticks * TICK_S >= self.rules.round_s

    def _end_round(self) -> list[Event]:
        self.shot = None
        replays = self.rules.replay and self._clips.best is not None
        self._enter(Phase.REPLAY if replays else Phase.OVER)
        return [RoundOver()]

    def _pause(self, reason: str) -> list[Event]:
        self.ball = self.shot = None
        self.pause_reason = reason
        self._enter(Phase.PAUSED)
        return [Paused(reason)]

    def _enter(self, phase: Phase) -> None:
        self.phase, self._phase_ticks = phase, 0
