"""The state of a track between frame sets: one body, whichever cues carry it."""

from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState, predict_state
from mocapd.geometry import rotations
from mocapd.types import Floats

# the prior of a body from another cue is as loose as a prediction over this time
NEW_BODY_PRIOR_S = 0.1
# Cameras, from which on the root's velocity is known in each direction; one camera, or two, measure what is noise in depth.
_ROOT_GOES_ON_FROM = 3


@dataclass(frozen=True, slots=True, eq=False)
class BodyShapeEstimate:
    """Body shape: factors (n_shape,) of the whole body, their information (n_shape,n_shape), and the seconds of good
    tracking from which they were learned."""

    factors: Floats
    information: Floats
    taught_s: float


@dataclass(frozen=True, slots=True, eq=False)
class TrackState:
    """A whole body at t_ns, the time of its last evidence.

    trunk: newest shirt fit of trunk and arms, None if the shirt is not visible; by_shirt: True if that fit places trunk
    and arms; whole: newest clothes fit, of the whole body or of legs and head below a trunk from the shirt, at whole_ns;
    legs_since_ns: first fit of legs and head; cameras: those that show the body; changed: parts of the body found away
    from their prediction; taught_s: see `BodyShapeEstimate`; off_keypoints_m: see `ClothesEstimate`, when keypoints were
    last detected.
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
    off_keypoints_m: Floats | None = None

    def with_shape(self, wearer: BodyShapeEstimate) -> "TrackState":
        """The same state with the caller's body shape."""
        motion = replace(self.motion, factors=wearer.factors, information=wearer.information)
        return replace(self, motion=motion, taught_s=wearer.taught_s)

    def predicted(self, model: BodyModel, dt_s: float, damping: float) -> MotionState:
        """The body dt_s later, which keeps a share `damping` of its velocity; of its root's all, where that is well known."""
        root = 1.0 if len(self.cameras) >= _ROOT_GOES_ON_FROM else damping
        return predict_state(model, self.motion, dt_s, damping, root)


def upper_body_state(whole: MotionState, upper: BodyModel) -> MotionState:
    """Trunk and arms of a whole body, whose pose parameters and factors come first. Keeps the local rotations of all
    joints."""
    n, s = upper.n_pose, upper.n_shape
    return replace(
        whole,
        velocity=whole.velocity[:n].copy(),
        factors=whole.factors[:s].copy(),
        information=whole.information[:s, :s].copy(),
    )


def t_pose_state(model: BodyModel, root_m: Floats, wearer: BodyShapeEstimate) -> MotionState:
    """A body in the T-pose at rest."""
    return resting_state(model, root_m, np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1)), wearer)


def resting_state(
    model: BodyModel, root_m: Floats, local_xyzw: Floats, wearer: BodyShapeEstimate
) -> MotionState:
    """A body at rest."""
    still = np.zeros(model.n_pose)
    return MotionState(root_m, local_xyzw, still, wearer.factors, wearer.information)
