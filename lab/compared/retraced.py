"""A recorded track as states that the fitter can draw, each with its motion and proportions."""

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import local_from_global, standard_skeleton
from mocapd.fit.motion_state import MotionState, initial_information, step_between
from mocapd.fit.solver import Fitter
from mocapd.geometry.rotations import inverse, rotate
from mocapd.session.offline import RecordedTrack
from mocapd.types import Floats


def proportions(model: BodyModel, joints_m: Floats, global_xyzw: Floats) -> Floats:
    """Shape factors (n_shape,) of the bones of a pose: joints_m (J,3), global_xyzw (J,4).

    Joints do not tell girths: those factors are 1.
    """
    parents = model.parents
    bones = rotate(inverse(global_xyzw[parents]), joints_m - joints_m[parents])[1:]
    mean = (model.rest_m - model.rest_m[parents])[1:]
    d_bones = (model.d_rest - model.d_rest[:, parents])[:, 1:]
    # the solution of least norm leaves alone what has no effect
    step = np.linalg.lstsq(
        d_bones.reshape(model.n_shape, -1).T, (bones - mean).ravel(), rcond=1e-6
    )[0]
    return np.asarray(1.0 + step, dtype=np.float64)


def states(fitter: Fitter, track: RecordedTrack) -> list[MotionState]:
    """The state of every frame of a track; its velocity is that since the frame before."""
    skeleton = standard_skeleton(fitter.model.stature_m)
    out: list[MotionState] = []
    for i, (joints, turned) in enumerate(zip(track.joints_m, track.global_xyzw, strict=True)):
        local = local_from_global(skeleton, turned)
        velocity = np.zeros(fitter.model.n_pose)
        if out:
            step = step_between(
                fitter.model, (joints[0], local), (out[-1].root_m, out[-1].local_xyzw)
            )
            velocity = step / max(track.times_s[i] - track.times_s[i - 1], 1e-3)
        factors = proportions(fitter.model, joints, turned)
        out.append(
            MotionState(
                joints[0], local, velocity, factors, initial_information(fitter.model.space)
            )
        )
    return out
