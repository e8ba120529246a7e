"""How hard the game is: a level that follows the player. Pure.

A weighted staircase: a save raises the level by a step, a goal lowers it by 7/3 of that, so that it settles where
seven of ten shots are saved.
"""

from dataclasses import dataclass

START_LEVEL = 0.25
STEP_UP, STEP_DOWN = 0.03, 0.07


@dataclass(frozen=True, slots=True)
class Difficulty:
    """level 0..1; everything else follows from it."""

    level: float = START_LEVEL

    def after(self, saved: bool) -> "Difficulty":
        """The level after one shot."""
        level = self.level + (STEP_UP if saved else -STEP_DOWN)
        return Difficulty(min(max(level, 0.0), 1.0))

    @property
    def speed_mps(self) -> float:
        """Mean speed of shots over the ground [m/s]: 0.45 s to react to the fastest from ten metres."""
        return 8.0 + 14.0 * self.level

    @property
    def pause_s(self) -> float:
        """From one shot's end to the next shot [s]."""
        return 1.5 - 0.7 * self.level

    @property
    def spread(self) -> float:
        """How much of the reach is needed, 0..1: 1 is as far as the player reached at calibration."""
        return 0.55 + 0.45 * self.level

    @property
    def trick_share(self) -> float:
        """Probability of a shot that bends or bounces."""
        return max(0.0, 0.9 * self.level - 0.15)
