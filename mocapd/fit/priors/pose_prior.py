"""Priors on a pose: joint limits, usual poses of limbs, upright hips.

Cameras with crossing views observe every direction, and leave only hidden arms open: a loose pull to everyday
motion will do, and a firmer one would bend visible arms. With a small baseline the depth is hardly observed:
there the body's shape and cloth mislead more than the prior does, so it has its full weight.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from mocapd.assets import asset_path
from mocapd.body.arrays import plain
from mocapd.body.model import BodyModel
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.errors import ConfigError
from mocapd.fit.fit_params import FitParams
from mocapd.fit.solve_kernels import PosePriors
from mocapd.geometry import rotations
from mocapd.geometry.rig_file import read_json
from mocapd.geometry.rotations import IDENTITY_XYZW
from mocapd.types import Floats

ASSET = "arm_motion.json"
_MIRROR = np.array([1.0, -1.0, -1.0])  # of a rotation vector, at x = 0


@dataclass(frozen=True, slots=True, eq=False)
class ArmMotion:
    """Of the left arm's collar, upper arm and forearm: mean_xyzw (3,4) local rotations, covariance_rad2 (9,9) of the pose
    step from there; decay_s: time constant of the velocity's decay."""

    mean_xyzw: Floats
    covariance_rad2: Floats
    decay_s: float

    def mirror_arm(self) -> "ArmMotion":
        """The right arm's."""
        signs = np.tile(_MIRROR, 3)
        return ArmMotion(
            self.mean_xyzw * np.append(_MIRROR, 1.0),
            self.covariance_rad2 * np.outer(signs, signs),
            self.decay_s,
        )


def load_arm_motion() -> ArmMotion:
    """What is in calib/, trained by `lab.training.train_arm_motion` on clips of real motion.

    Raises ConfigError when the file is none of this kind.
    """
    path = asset_path(ASSET)
    data = read_json(path)
    mean, covariance = (np.asarray(data.get(k), float) for k in ("mean_xyzw", "covariance_rad2"))
    decay_s = data.get("glide_s")
    if (
        mean.shape != (3, 4)
        or covariance.shape != (9, 9)
        or np.linalg.eigvalsh(covariance).min() <= 0.0
        or not isinstance(decay_s, float)
    ):
        raise ConfigError("is no prior of arm motion", str(path), "install mocapd again")
    return ArmMotion(mean, covariance, decay_s)


_BONES = ("Shoulder", "UpperArm", "LowerArm")
_SPINE_SD_RAD = (0.5, 0.5, 0.4)
_COLLAR_SD_RAD = (0.2, 0.2, 0.2)
_FREE = 1e3
# Of a whole body's left side and trunk: mean and spread over 34 clips of everyday motion and sport (CMU, HDM05), each clip
# of the same weight, upright people a little more. A knee hardly twists; what it seems to is the thigh's.
_LEG_REST_RAD = {
    "UpperLeg": (-0.25, 0.0, 0.0),
    "LowerLeg": (0.5, 0.0, 0.0),
    "Foot": (-0.25, 0.1, 0.0),
}
_LEG_SD_RAD = {
    "UpperLeg": (0.5, 0.25, 0.25),
    "LowerLeg": (0.55, 0.05, 0.1),
    "Foot": (0.35, 0.25, 0.2),
}
_WHOLE_SPINE_SD_RAD = (0.3, 0.08, 0.14)
_NECK_REST_RAD, _NECK_SD_RAD = (0.25, 0.0, 0.0), (0.35, 0.45, 0.2)


def arm_motions() -> Mapping[str, ArmMotion]:
    """Prior pose of the arm of each side."""
    left = load_arm_motion()
    return {"left": left, "right": left.mirror_arm()}


def wide_baseline_prior(model: BodyModel, p: FitParams) -> PosePriors:
    """For cameras with crossing views."""
    rest = np.tile(IDENTITY_XYZW, (N_JOINTS, 1))
    for side, mirror in (("left", 1.0), ("right", -1.0)):
        for bone, (x, y, z) in (
            ("UpperArm", p.upper_arm_rest_rad),
            ("LowerArm", p.elbow_rest_rad),
        ):
            rest[INDEX[side + bone]] = rotations.exp(np.array([x, mirror * y, mirror * z]))
    upper, elbow = (p.upper_arm_sd_rad,) * 3, p.elbow_sd_rad
    sd = model.space.by_group({
        "hips": (_FREE,) * 3, "spine": _SPINE_SD_RAD,
        "leftShoulder": _COLLAR_SD_RAD, "rightShoulder": _COLLAR_SD_RAD,
        # an elbow bends about y, twists about x, and hardly about z
        "leftUpperArm": upper, "rightUpperArm": upper, "leftLowerArm": elbow, "rightLowerArm": elbow,
    }, 1.0)  # fmt: skip
    information = np.diag(np.concatenate([np.zeros(3), 1.0 / sd**2]))
    if model.space.whole:
        _hold_feet(model, information)
    return _priors(model, p, rest, information, 0.0)


def hidden_legs_prior(model: BodyModel, p: FitParams) -> PosePriors:
    """The same where pictures hardly show the feet: legs go back to where they usually are. Held so where they are seen,
    squats and kicks would be too low."""
    wide = wide_baseline_prior(model, p)
    rest, information = wide.rest_local.copy(), wide.rest_information.copy()
    if model.space.whole:
        _hold_legs(model, rest, information, ("UpperLeg", "LowerLeg"))
    return _priors(model, p, rest, information, 0.0)


def small_baseline_prior(model: BodyModel, p: FitParams) -> PosePriors:
    """For cameras on a small baseline: the depth is hardly observed."""
    wide = wide_baseline_prior(model, p)
    rest, information = wide.rest_local.copy(), wide.rest_information.copy()
    for side, arm in arm_motions().items():
        rest[[INDEX[side + bone] for bone in _BONES]] = arm.mean_xyzw
        columns = model.space.columns(f"{side}_arm")
        information[columns, columns] = np.linalg.inv(arm.covariance_rad2)
    if model.space.whole:
        _hold_whole(model, rest, information)
    return _priors(model, p, rest, information, 1.0 / p.tilt_sd_rad**2)


def _hold_whole(model: BodyModel, rest: Floats, information: Floats) -> None:
    """Trunk, neck and legs of a whole body, where they usually are."""
    for name, sd in {"neck": _NECK_SD_RAD, "spine": _WHOLE_SPINE_SD_RAD}.items():
        _hold(model, information, name, sd)
    half_neck = rotations.exp(0.5 * np.array(_NECK_REST_RAD))
    rest[INDEX["neck"]] = rest[INDEX["head"]] = half_neck
    _hold_legs(model, rest, information, tuple(_LEG_REST_RAD))


def _hold_feet(model: BodyModel, information: Floats) -> None:
    """Feet do not roll or turn far below their shins, and bend as they like: what shows of a shoe says little of it."""
    for side in ("left", "right"):
        _hold(model, information, side + "Foot", (1.0, *_LEG_SD_RAD["Foot"][1:]))


def _hold_legs(model: BodyModel, rest: Floats, information: Floats, bones: tuple[str, ...]) -> None:
    """These bones of both legs, where they usually are."""
    for side, mirror in (("left", 1.0), ("right", -1.0)):
        for bone in bones:
            x, y, z = _LEG_REST_RAD[bone]
            rest[INDEX[side + bone]] = rotations.exp(np.array([x, mirror * y, mirror * z]))
            _hold(model, information, side + bone, _LEG_SD_RAD[bone])


def _hold(
    model: BodyModel, information: Floats, joint: str, sd_rad: tuple[float, float, float]
) -> None:
    first = 3 + 3 * model.space.group(joint)
    columns = slice(first, first + 3)
    information[columns, columns] = np.diag(1.0 / np.square(sd_rad))


def usual_leg(side: str) -> Floats:
    """Local rotations (3,4) of thigh, shank and foot where they usually are."""
    mirror = 1.0 if side == "left" else -1.0
    return np.array([
        rotations.exp(np.array([x, mirror * y, mirror * z])) for x, y, z in _LEG_REST_RAD.values()
    ])  # fmt: skip


def unusual_leg(poses_xyzw: Floats, side: str) -> Floats:
    """Squared Mahalanobis distances (N,) of poses (N,3,4) of thigh, shank and foot from where they usually are."""
    turned = rotations.log(rotations.multiply(poses_xyzw, rotations.inverse(usual_leg(side))))
    squared = (turned / np.array(list(_LEG_SD_RAD.values()))) ** 2
    out: Floats = squared.reshape(len(poses_xyzw), -1).sum(axis=1)
    return out


def seldom(squared: Floats, tail: float) -> Floats:
    """What poses cost by their squared Mahalanobis distances (N,): about these up to `tail`, beyond it ever less more, as by
    Student's t. People do what they seldom do."""
    out: Floats = tail * np.log1p(squared / tail)
    return out


def unusualness(poses_xyzw: Floats, arm: ArmMotion) -> Floats:
    """Squared Mahalanobis distances (N,) of poses (N,3,4) of an arm from where it usually is."""
    away = rotations.log(rotations.multiply(poses_xyzw, rotations.inverse(arm.mean_xyzw)))
    away = away.reshape(len(poses_xyzw), -1)
    information = _information(arm)
    squared: Floats = np.einsum("ni,ij,nj->n", away, information, away)
    return squared


@cache
def _information(arm: ArmMotion) -> Floats:
    """(9,9) of its pose."""
    return np.asarray(np.linalg.inv(arm.covariance_rad2), dtype=np.float64)


def _priors(
    model: BodyModel, p: FitParams, rest: Floats, information: Floats, tilt: float
) -> PosePriors:
    return PosePriors(rest, information, plain(model.space.limits), 1.0 / p.limit_sd_rad**2, tilt)
