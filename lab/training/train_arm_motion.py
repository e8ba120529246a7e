"""Learn from clips of real motion where arms are and how they move when nobody looks, for `mocapd.fit.priors.pose_prior`.

python -m lab.training.train_arm_motion CLIPS calib/arm_motion.json

Both arms are one population, mirrored; each clip counts the same, however long.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

from lab.simulated.motion_clip import MotionClip, read_clip
from mocapd.body.skeleton import INDEX, local_from_global, standard_skeleton
from mocapd.geometry import rotations
from mocapd.types import Floats

_BONES = ("Shoulder", "UpperArm", "LowerArm")
_MIRROR = np.array([1.0, -1.0, -1.0, 1.0])  # of a rotation, at x = 0
# what clips of other bodies do not tell better [rad]: a collar hardly moves in them, twist is uncertain
_FLOOR_RAD = np.array([0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 0.4, 0.25, 0.25])
_ROUNDS = 20  # of the mean, which settles in a few
_LAGS_S = (0.1, 0.2, 0.4)  # over which velocity is forgotten


def arms_of(clip: MotionClip) -> list[Floats]:
    """Local rotations (F,3,4) of collar, upper arm and forearm: the left arm's, and the right one's mirrored."""
    skeleton = standard_skeleton(1.75)
    local = np.array([local_from_global(skeleton, frame) for frame in clip.global_xyzw])
    left, right = (local[:, [INDEX[side + bone] for bone in _BONES]] for side in ("left", "right"))
    return [left, rotations.canonical(right * _MIRROR)]


def mean_rotation(samples_xyzw: Floats, weight: Floats) -> Floats:
    """The rotation (4,) from which samples (N,4) are least away; weight (N,) sums to one."""
    mean = samples_xyzw[0]
    for _ in range(_ROUNDS):
        away = _from(mean, samples_xyzw)
        mean = rotations.multiply(rotations.exp(weight @ away), mean)
    return rotations.canonical(mean)


def _from(mean_xyzw: Floats, samples_xyzw: Floats) -> Floats:
    """Rotation vectors (N,3) [rad] from the mean to samples (N,4), in the parent's frame as pose steps are."""
    away: Floats = rotations.log(rotations.multiply(samples_xyzw, rotations.inverse(mean_xyzw)))
    return away


def _per_frame(poses: Floats, rate_hz: float) -> Floats:
    """Velocity (F-1,9) [rad/s] of poses (F,3,4)."""
    turned = rotations.log(rotations.multiply(poses[1:], rotations.inverse(poses[:-1])))
    velocity: Floats = turned.reshape(len(turned), 9) * rate_hz
    return velocity


def forgetting_s(arms: list[tuple[Floats, float]]) -> float:
    """After how long a velocity is down to 1/e, on average of arms (poses, rate_hz)."""
    kept = []
    for lag_s in _LAGS_S:
        same = together = 0.0
        for poses, rate_hz in arms:
            v, lag = _per_frame(poses, rate_hz), round(lag_s * rate_hz)
            if len(v) > lag:
                same += float((v[:-lag] * v[:-lag]).mean())
                together += float((v[lag:] * v[:-lag]).mean())
        kept.append(max(together / same, 1e-3))
    return float(
        np.mean([-lag_s / np.log(share) for lag_s, share in zip(_LAGS_S, kept, strict=True)])
    )


def main() -> int:
    """Train and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("clips", type=Path)
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    clips = [read_clip(path) for path in sorted(arguments.clips.glob("[!.]*.npz"))]
    arms = [(poses, clip.rate_hz) for clip in clips for poses in arms_of(clip)]
    samples = np.concatenate([poses for poses, _ in arms])
    weight = np.concatenate([np.full(len(p), 1.0 / (len(p) * len(arms))) for p, _ in arms])
    mean = np.array([mean_rotation(samples[:, place], weight) for place in range(3)])
    away = np.concatenate([_from(mean[place], samples[:, place]) for place in range(3)], axis=1)
    covariance = (away * weight[:, None]).T @ away + np.diag(_FLOOR_RAD**2)
    speed = np.concatenate([_per_frame(poses, rate_hz) for poses, rate_hz in arms])
    glide_s = forgetting_s(arms)
    about = (
        "Where arms are, trained on clips of real motion by lab.training.train_arm_motion: mean local rotations of "
        "the left collar, upper arm and forearm, the covariance about them [rad^2, in the parent's frame] and after "
        "how long a velocity is down to 1/e"
    )
    trained = {
        "mean_xyzw": np.round(mean, 5).tolist(),
        "covariance_rad2": np.round(covariance, 5).tolist(),
        "glide_s": round(glide_s, 3),
    }
    arguments.out.write_text(json.dumps({"about": about, **trained}) + "\n", encoding="utf-8")
    spread_deg = np.degrees(np.sqrt(np.diag(covariance))).round(0)
    sys.stdout.write(
        f"{len(clips)} clips, {len(samples)} arms; spread {spread_deg} degrees; velocity {np.sqrt((speed**2).mean()):.2f} "
        f"rad/s, forgotten in {glide_s:.2f} s\n"
    )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
