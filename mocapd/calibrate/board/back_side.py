"""The back of a two-sided board: its alignment with the front, and a verdict on the gluing.

An offset (4,) has: the shift of the back print's middle from the front's, along a row and down it [m], the
rotation about that middle [rad], and the thickness of the board [m]; all in the board's frame, so right, down
and clockwise are as viewed from the front.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.types import Floats

OFFSET = 4
# limits above which the user gets a warning
_SHIFT_MM, _TURN_DEG = 3.0, 1.0
_LEAST_SIGMAS = 3.0  # smaller deviations may be chance
_UNKNOWN_MM = 3.0  # standard deviation of the shift or of the thickness


@dataclass(frozen=True, slots=True)
class GluingPrior:
    """The prior of an offset: its mean and standard deviations.

    The thickness spans a sheet printed on both sides and a plate of foam of 10 mm.
    """

    mean: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.004)
    deviation: tuple[float, float, float, float] = (0.01, 0.01, 0.02, 0.004)


@dataclass(frozen=True, slots=True, eq=False)
class BackPrint:
    """The pose of the back's print: `offset` (4,), and `middle_m` (3,) of the front's, in the board's frame."""

    middle_m: Floats
    offset: Floats

    @property
    def board_from_back(self) -> RigidTransform:
        """Takes a corner from its place on the front to its place on the back."""
        x_m, y_m, turn_rad, thickness_m = self.offset
        c, s = np.cos(turn_rad), np.sin(turn_rad)
        R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        shift_m = np.array([x_m, y_m, thickness_m])
        return RigidTransform(R, self.middle_m + shift_m - R @ self.middle_m)

    def slopes(self, points_m: Floats) -> Floats:
        """(N,3,4): derivatives of the front's corners (N,3), taken to the back, with respect to the offset."""
        arm_m = self.board_from_back.rotate(points_m - self.middle_m)
        out = np.zeros((len(points_m), 3, OFFSET))
        out[:, 0, 0] = out[:, 1, 1] = out[:, 2, 3] = 1.0
        out[:, 0, 2], out[:, 1, 2] = -arm_m[:, 1], arm_m[:, 0]
        return out

    def with_step(self, step: Floats) -> "BackPrint":
        """With a step (4,) added to the offset."""
        return BackPrint(self.middle_m, self.offset + step)


def usual_back(board_m: Floats, prior: GluingPrior | None = None) -> BackPrint:
    """The prior's mean offset, for a board with these corners (n,3)."""
    return BackPrint(board_m.mean(axis=0), np.array((prior or GluingPrior()).mean))


@dataclass(frozen=True, slots=True)
class Gluing:
    """The measured gluing of the back; the module's docstring gives the directions.

    `shift_deviation_mm`, `thickness_deviation_mm`: standard deviations, of the worse direction.
    """

    right_mm: float
    down_mm: float
    clockwise_deg: float
    thickness_mm: float
    shift_deviation_mm: float
    turn_deviation_deg: float
    thickness_deviation_mm: float

    def __str__(self) -> str:
        return (
            f"{abs(self.right_mm):.1f} mm to the {'right' if self.right_mm >= 0.0 else 'left'} and "
            f"{abs(self.down_mm):.1f} mm {'below' if self.down_mm >= 0.0 else 'above'} "
            f"(± {self.shift_deviation_mm:.1f} mm), turned by {abs(self.clockwise_deg):.1f} degrees "
            f"{'clockwise' if self.clockwise_deg >= 0.0 else 'anticlockwise'}, seen from the front; "
            f"the board is {self.thickness_mm:.1f} mm thick (± {self.thickness_deviation_mm:.1f} mm)"
        )


def gluing_of(back: BackPrint, deviation: Floats) -> Gluing:
    """`deviation` (4,): standard deviations of the offset."""
    x_m, y_m, turn_rad, thickness_m = back.offset
    return Gluing(
        1000.0 * float(x_m),
        1000.0 * float(y_m),
        float(np.degrees(turn_rad)),
        1000.0 * float(thickness_m),
        1000.0 * float(deviation[:2].max()),
        float(np.degrees(deviation[2])),
        1000.0 * float(deviation[3]),
    )


def gluing_trouble(gluing: Gluing) -> str:
    """A warning and its remedy; "" where the gluing is good and measured precisely."""
    shift_mm = float(np.hypot(gluing.right_mm, gluing.down_mm))
    shifted = shift_mm > max(_SHIFT_MM, _LEAST_SIGMAS * gluing.shift_deviation_mm)
    turned = abs(gluing.clockwise_deg) > max(_TURN_DEG, _LEAST_SIGMAS * gluing.turn_deviation_deg)
    if shifted or turned:
        return (
            f"the back of the board is not glued in register with its front: it lies {gluing}. The cameras "
            "are right all the same, for this was measured; glue it again, cross on cross, before you "
            "use the board with other programs"
        )
    unknown_mm = max(gluing.shift_deviation_mm, gluing.thickness_deviation_mm)
    if unknown_mm > _UNKNOWN_MM:
        return (
            f"how the back of the board lies on its front is known to {unknown_mm:.0f} mm only, and so are "
            "the cameras that see the one to those that see the other: turn the board over, and tilt "
            "it, before the same cameras"
        )
    return ""
