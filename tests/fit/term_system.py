"""The normal equations of one term, of a whole body in any pose."""

import numpy as np

from mocapd.body.arrays import PosedJoints
from mocapd.body.model import Shaper, build_model
from mocapd.body.pose_space import full_body
from mocapd.body.posing_kernels import forward_kinematics
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.terms.term import Term
from mocapd.types import Floats

BODY = build_model(1.75, full_body())
SHAPED = Shaper(BODY)(np.ones(BODY.n_shape))


def posed(root: Floats, local: Floats) -> PosedJoints:
    out = PosedJoints(
        SHAPED.rest, np.empty((N_JOINTS, 3, 3)), np.empty((N_JOINTS, 3)), np.empty((N_JOINTS, 4))
    )
    forward_kinematics(BODY.parents, SHAPED.rest, root, local, out.R, out.joints, out.quats)
    return out


def system(term: Term, root: Floats, local: Floats) -> tuple[float, Floats, Floats]:
    H, b = np.zeros((BODY.n_pose, BODY.n_pose)), np.zeros(BODY.n_pose)
    return term.add(posed(root, local), SHAPED, H, b), H, b
