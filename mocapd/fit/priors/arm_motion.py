"""Prior pose of unobserved arms, trained by `lab.training.train_arm_motion` on clips of real motion."""

from dataclasses import dataclass

import numpy as np

from mocapd.assets import asset_path
from mocapd.errors import ConfigError
from mocapd.geometry.rig_file import read_json
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
    """What is in calib/. Raises ConfigError when the file is none of this kind."""
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
