"""What is told of somebody who is followed: the pose, steadied, and how far each of its joints may be believed."""

from collections.abc import Sequence

from mocapd.body.model import BodyModel
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions
from mocapd.clock import seconds
from mocapd.fit.solver import Fitter
from mocapd.trackers.flex.limb_confidence import joint_confidence
from mocapd.trackers.flex.memory import Followed
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.rescue.seen_pose import WHOLE
from mocapd.trackers.steadying import Told, behind, steadied
from mocapd.trackers.told_pose import told_pose
from mocapd.trackers.tracking_state import grown
from mocapd.types import BodyState, Tracking


def told_of(
    known: Followed,
    last: Told | None,
    t_ns: int,
    tracking: Tracking,
    tracker: str,
    fitter: Fitter,
    shape: BodyShape,
    params: Params,
) -> tuple[BodyState, Told]:
    """The body at t_ns, in the tracker's name, and its pose, which the next one follows; last: what was told before."""
    away_s = seconds(t_ns - known.t_ns)
    found = told_pose(fitter, known.state, known.fit, None, away_s, params.prediction_damping)
    confidence = joint_confidence(known.fit, len(known.cameras), found.uncertainty_m, away_s)
    jumped = _bones(fitter.model, known.changed) if away_s == 0.0 else ()
    told = steadied(found.pose, confidence, t_ns, last, params.steadying, jumped)
    joints_m = joint_positions(skeleton_of(shape), told.pose)
    body = BodyState(
        t_ns=t_ns,
        tracking=tracking,
        tracker=tracker,
        pose=told.pose,
        joints_m=joints_m,
        confidence=confidence,
        cameras=known.cameras if away_s == 0.0 else (),
        uncertainty_m=behind(grown(found.uncertainty_m, away_s), joints_m, found.joints_m),
    )
    return body, told


def _bones(model: BodyModel, parts: Sequence[str]) -> tuple[int, ...]:
    if WHOLE in parts:
        return tuple(range(N_JOINTS))
    return tuple(INDEX[bone] for part in parts for bone in model.space.parts[part].joints)
