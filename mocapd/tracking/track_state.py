"""All that is carried from frame to frame of somebody who is tracked: one body, whichever cues carry it."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.geometry import rotations
from mocapd.types import Floats

BEGUN_S = 0.1  # a body that other cues placed is held as loosely as a prediction over this time


@dataclass(frozen=True, slots=True, eq=False)
class Proportions:
    """The proportions as handed in: factors (n_shape,) of the whole body with their information (n_shape,n_shape), and
    for how many seconds of good tracking they were learned."""

    factors: Floats
    information: Floats
    taught_s: float


@dataclass(frozen=True, slots=True, eq=False)
class TrackState:
    """A whole body as it was last confirmed, at t_ns.

    trunk: the newest fit of trunk and arms to the shirt, None where it is not seen; by_shirt: whether that carries them;
    whole: the newest fit to the clothes, of the whole body or of legs and head below a carried trunk, at whole_ns;
    legs_since_ns: when legs and head were first found; cameras: those that showed the body; changed: parts of the body that
    were found elsewhere than predicted; taught_s: see `Proportions`.
    """

    t_ns: int
    motion: MotionState
    cameras: tuple[str, ...]
    trunk: Fit | None = None
    whole: Fit | None = None
    whole_ns: int = 0
    legs_since_ns: int | None = None
    changed: tuple[str, ...] = ()
    taught_s: float = 0.0
    by_shirt: bool = False

    def of(self, wearer: Proportions) -> "TrackState":
        """The same of a wearer as known to whoever steps the tracker."""
        motion = replace(self.motion, factors=wearer.factors, information=wearer.information)
        return replace(self, motion=motion, taught_s=wearer.taught_s)


def upper_of(whole: MotionState, upper: BodyModel) -> MotionState:
    """Trunk and arms of a whole body, whose pose and factors begin with theirs; the local rotations of all joints stay."""
    n, s = upper.n_pose, upper.n_shape
    return replace(
        whole,
        velocity=whole.velocity[:n].copy(),
        factors=whole.factors[:s].copy(),
        information=whole.information[:s, :s].copy(),
    )


def in_t_pose(model: BodyModel, root_m: Floats, wearer: Proportions) -> MotionState:
    """Somebody in the T-pose who does not move."""
    return at_rest(model, root_m, np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)), wearer)


def at_rest(
    model: BodyModel, root_m: Floats, local_xyzw: Floats, wearer: Proportions
) -> MotionState:
    """Somebody who does not move."""
    still = np.zeros(model.n_pose)
    return MotionState(root_m, local_xyzw, still, wearer.factors, wearer.information)
