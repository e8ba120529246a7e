"""A clip of recorded motion: read, checked, and done by a person of another build."""

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.body.skeleton import INDEX
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.sim.world import Performed, PoseAt
from mocapd.types import Floats, Pose, Skeleton

_FIELDS = ("fps", "names", "rest_offsets", "global_quats", "hips_pos")
_MENDED = "give a folder of clips of motion"
_LEG = ("LowerLeg", "Foot")


@dataclass(frozen=True, slots=True, eq=False)
class MotionClip:
    """hips_m (F,3); global_xyzw (F,J,4) since the T-pose, of all our joints; leg_m: from hip to ankle."""

    name: str
    rate_hz: float
    hips_m: Floats
    global_xyzw: Floats
    leg_m: float


@dataclass(frozen=True, slots=True)
class Placement:
    """Which part of a clip is done, and where. begin, frames: of the clip; yaw_deg: to where the person then looks on
    average, 0 is +Z; the middle of the way is the world's origin. Before, it stands for `stand_s` in the T-pose, and
    goes over to the clip in `blend_s`."""

    begin: int
    frames: int
    yaw_deg: float
    stand_s: float
    blend_s: float


def read_clip(path: Path) -> MotionClip:
    """Raises InputError naming the file."""
    try:
        with np.load(path, allow_pickle=False) as data:
            missing = [field for field in _FIELDS if field not in data.files]
            if missing:
                raise InputError(f"is no clip: it lacks {', '.join(missing)}", str(path), _MENDED)
            names = [str(name) for name in data["names"]]
            offsets_m, hips_m = data["rest_offsets"].astype(float), data["hips_pos"].astype(float)
            quats, rate_hz = data["global_quats"].astype(float), float(data["fps"])
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(f"cannot be read ({error})", str(path), _MENDED) from None
    asked = ("hips", *(side + bone for side in ("left", "right") for bone in _LEG))
    if (
        any(name not in names for name in asked)
        or quats.shape != (len(hips_m), len(names), 4)
        or offsets_m.shape != (len(names), 3)
        or len(hips_m) < 2
        or not np.isfinite(quats).all()
        or not rate_hz > 0.0
    ):
        raise InputError("is no clip of a humanoid", str(path), _MENDED)
    leg_m = sum(float(np.linalg.norm(offsets_m[names.index("left" + bone)])) for bone in _LEG)
    return MotionClip(path.stem, rate_hz, hips_m, _all_joints(names, quats), leg_m)


def _all_joints(names: list[str], quats_xyzw: Floats) -> Floats:
    """Of each of our joints; one that the clip lacks is turned as the one above it."""
    out = np.empty((len(quats_xyzw), len(NAMES), 4))
    for name in NAMES:
        known = (
            quats_xyzw[:, names.index(name)] if name in names else out[:, INDEX[PARENT_OF[name]]]
        )
        out[:, INDEX[name]] = known
    return rotations.canonical(out)


def within(clip: MotionClip, seconds: float, most_m: float) -> int | None:
    """The first frame from which the person stays within a square of that side for so long; None when it never does."""
    frames = round(seconds * clip.rate_hz)
    for begin in range(0, len(clip.hips_m) - frames + 1, 10):
        way_m = clip.hips_m[begin : begin + frames, [0, 2]]
        if np.ptp(way_m, axis=0).max() <= most_m:
            return begin
    return None


def performed(clip: MotionClip, where: Placement) -> Performed:
    """What a person of any skeleton does: the clip's rotations, its way in proportion to the legs."""
    last = where.begin + where.frames
    hips_m, quats = clip.hips_m[where.begin : last].copy(), clip.global_xyzw[where.begin : last]
    ahead = rotations.to_matrix(quats[:, 0])[:, :, 2].mean(axis=0)
    turn_rad = np.radians(where.yaw_deg) - np.arctan2(ahead[0], ahead[2])
    turn_xyzw = rotations.exp(np.array([0.0, turn_rad, 0.0]))
    hips_m[:, [0, 2]] -= (hips_m[:, [0, 2]].min(axis=0) + hips_m[:, [0, 2]].max(axis=0)) / 2.0
    hips_m = rotations.rotate(turn_xyzw, hips_m)
    quats = rotations.canonical(rotations.multiply(turn_xyzw, quats))

    def by(skeleton: Skeleton) -> PoseAt:
        rest_m = skeleton.rest_m
        chain = [INDEX["left" + bone] for bone in ("UpperLeg", *_LEG)]
        leg_m = float(np.linalg.norm(np.diff(rest_m[chain], axis=0), axis=1).sum())
        way_m = hips_m * (leg_m / clip.leg_m)
        standing_m = np.array([way_m[0, 0], rest_m[0, 1], way_m[0, 2]])
        heading_rad = np.radians(where.yaw_deg)
        upright = np.tile(rotations.exp(np.array([0.0, heading_rad, 0.0])), (len(NAMES), 1))

        def pose_at(t_s: float) -> Pose:
            frame = np.clip(
                (t_s - where.stand_s - where.blend_s) * clip.rate_hz, 0.0, len(quats) - 1.0
            )
            k = min(int(frame), len(quats) - 2)
            share = frame - k
            root_m = (1.0 - share) * way_m[k] + share * way_m[k + 1]
            turned = _between(quats[k], quats[k + 1], share)
            begun = np.clip((t_s - where.stand_s) / where.blend_s, 0.0, 1.0)
            begun = begun * begun * (3.0 - 2.0 * begun)
            if begun < 1.0:
                root_m = (1.0 - begun) * standing_m + begun * root_m
                turned = _between(upright, turned, begun)
            return Pose(root_m, turned)

        return pose_at

    return by


def _between(a_xyzw: Floats, b_xyzw: Floats, share: float) -> Floats:
    """The shortest way from a to b, at an even pace."""
    way = rotations.log(rotations.multiply(b_xyzw, rotations.inverse(a_xyzw)))
    return rotations.canonical(rotations.multiply(rotations.exp(share * way), a_xyzw))
