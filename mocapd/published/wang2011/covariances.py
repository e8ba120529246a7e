"""The three covariances of the inverse kinematics, trained by `lab.training.train_covariances`. [section 5.2, step 4]"""

from dataclasses import dataclass

import numpy as np

from mocapd.assets import asset_path
from mocapd.body.pose_space import upper_body
from mocapd.errors import ConfigError
from mocapd.geometry.rig_file import read_json
from mocapd.types import Floats

ASSET = "ik_covariances.json"


@dataclass(frozen=True, slots=True, eq=False)
class Covariances:
    """centroid (2,2) [px^2]; blend and previous (P,P) [m, rad] of the pose step of body.model.

    `previous` is that of one frame of 1/30 s.
    """

    centroid: Floats
    blend: Floats
    previous: Floats


def load_covariances() -> Covariances:
    """The covariances of calib/. Raises ConfigError when the file does not fit the body."""
    path = asset_path(ASSET)
    data = read_json(path)
    n_pose = upper_body().n_pose
    wanted = {"centroid_px2": 2, "blend": n_pose, "previous": n_pose}
    matrices = []
    for key, n in wanted.items():
        matrix = np.asarray(data.get(key), dtype=float)
        if matrix.shape != (n, n) or np.linalg.eigvalsh(matrix).min() <= 0.0:
            raise ConfigError(
                f"{key!r} is not a covariance matrix of size {n}",
                str(path),
                "install mocapd again",
            )
        matrices.append(matrix)
    return Covariances(*matrices)
