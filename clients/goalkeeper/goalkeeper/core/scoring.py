"""Points, streaks and the table of one round. Pure."""

from dataclasses import dataclass, replace

from goalkeeper.core.limbs import Part

# A hand is where one wants the ball; the face is brave.
_POINTS = {Part.HAND: 100, Part.ARM: 80, Part.BODY: 60, Part.HEAD: 120, Part.LEG: 80}
# Saves in a row from which on every save counts so many times.
MULTIPLIERS = ((10, 4), (6, 3), (3, 2))
_USUAL_SPEED_MPS = 10.0


@dataclass(frozen=True, slots=True)
class Score:
    """One round so far."""

    points: int = 0
    saves: int = 0
    goals: int = 0
    streak: int = 0
    best_streak: int = 0

    @property
    def multiplier(self) -> int:
        """What the next save counts times."""
        return next((times for least, times in MULTIPLIERS if self.streak >= least), 1)

    def worth(self, part: Part, speed_mps: float) -> int:
        """Points of a save now: by what stopped the ball, how fast it was, and the streak."""
        return round(_POINTS[part] * speed_mps / _USUAL_SPEED_MPS) * self.multiplier

    def with_save(self, part: Part, speed_mps: float) -> "Score":
        """After a save."""
        streak = self.streak + 1
        return Score(
            self.points + self.worth(part, speed_mps),
            self.saves + 1,
            self.goals,
            streak,
            max(self.best_streak, streak),
        )

    def with_goal(self) -> "Score":
        """After a goal: the streak is over."""
        return replace(self, goals=self.goals + 1, streak=0)
