"""A clip of recorded motion: read, checked, and done by a person of another build."""

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mocapd.body.bones import NAMES, PARENT_OF
from mocapd.body.skeleton import INDEX, global_from_local, joint_positions
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.sim.person.motion import local_rotvecs
from mocapd.sim.person_spec import PoseKeyframe
from mocapd.sim.world import Performed, PoseAt
from mocapd.types import Floats, Pose, Skeleton

_FIELDS = ("fps", "names", "rest_offsets", "global_quats", "hips_pos")
_MENDED = "give a folder of clips of motion"
_LEG = ("LowerLeg", "Foot")
_SIDES = ("left", "right")


def upright_pose(skeleton: Skeleton, pose: str, heading_rad: float) -> Pose:
    """One of POSES at the origin, with straight legs."""
    local = rotations.exp(local_rotvecs(PoseKeyframe(t_s=0.0, pose=pose)))
    local[0] = rotations.exp(np.array([0.0, heading_rad, 0.0]))
    root = np.array([0.0, skeleton.rest_m[0, 1], 0.0])
    return Pose(root, rotations.canonical(global_from_local(skeleton, local)))


@dataclass(frozen=True, slots=True, eq=False)
class MotionClip:
    """hips_m (F,3); global_xyzw (F,J,4) since the T-pose, of all our joints; leg_m: from hip to ankle; ankle_m (F,):
    height of the lower ankle."""

    name: str
    rate_hz: float
    hips_m: Floats
    global_xyzw: Floats
    leg_m: float
    ankle_m: Floats


@dataclass(frozen=True, slots=True)
class Placement:
    """Which part of a clip is done, and where. begin, frames: of the clip; yaw_deg: to where the person then looks on
    average, 0 is +Z; the middle of the way is the world's origin. Before, it stands for `stand_s` in the T-pose or
    another named pose, `stance`, and goes over to the clip in `blend_s`."""

    begin: int
    frames: int
    yaw_deg: float
    stand_s: float
    blend_s: float
    stance: str = "t_pose"


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
    asked = ("hips", *(side + bone for side in _SIDES for bone in _LEG))
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
    ours = _all_joints(names, quats)
    ankle_m = np.min([_ankle_m(side, names, offsets_m, hips_m, ours) for side in _SIDES], axis=0)
    return MotionClip(path.stem, rate_hz, hips_m, ours, leg_m, ankle_m)


def _ankle_m(
    side: str, names: list[str], offsets_m: Floats, hips_m: Floats, quats: Floats
) -> Floats:
    """Height (F,) of one ankle by the clip's own bones."""
    chain = [bone for bone in ("UpperLeg", *_LEG) if side + bone in names]
    height: Floats = hips_m[:, 1].copy()
    for above, bone in zip(["hips", *(side + one for one in chain)], chain, strict=False):
        offset = offsets_m[names.index(side + bone)]
        height += rotations.rotate(quats[:, INDEX[above]], offset)[:, 1]
    return height


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
    """What a person of any skeleton does: the clip's rotations, its way in proportion to the legs.

    The lower ankle is as high as the clip's, which legs of other proportions would not keep by themselves.
    """
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
        over_m = clip.ankle_m[where.begin : last] - np.quantile(clip.ankle_m, 0.05)
        way_m[:, 1] += over_m * (leg_m / clip.leg_m) - _over_floor_m(skeleton, way_m, quats)
        standing_m = np.array([way_m[0, 0], rest_m[0, 1], way_m[0, 2]])
        heading_rad = np.radians(where.yaw_deg)
        upright = np.tile(rotations.exp(np.array([0.0, heading_rad, 0.0])), (len(NAMES), 1))
        if where.stance != "t_pose":
            upright = upright_pose(skeleton, where.stance, heading_rad).quats_xyzw

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


def _over_floor_m(skeleton: Skeleton, hips_m: Floats, quats: Floats) -> Floats:
    """How much higher the lower ankle is than when standing (F,) [m]."""
    ankles = [INDEX[side + "Foot"] for side in _SIDES]
    heights = [
        joint_positions(skeleton, Pose(hips, turned))[ankles, 1].min()
        for hips, turned in zip(hips_m, quats, strict=True)
    ]
    over: Floats = np.array(heights) - skeleton.rest_m[ankles[0], 1]
    return over


def _between(a_xyzw: Floats, b_xyzw: Floats, share: float) -> Floats:
    """The shortest way from a to b, at an even pace."""
    way = rotations.log(rotations.multiply(b_xyzw, rotations.inverse(a_xyzw)))
    return rotations.canonical(rotations.multiply(rotations.exp(share * way), a_xyzw))
