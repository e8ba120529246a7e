"""From skeleton frames of one person to VMC datagrams."""

from dataclasses import dataclass

from mocapd.body.bones import other_side
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.vmc.avatar import Avatar, mirror_avatar, reflect_position, wearer_avatar
from mocapd.outputs.vmc.bone_names import is_leaf
from mocapd.outputs.vmc.vmc_packets import Bundling, VmcPackets
from mocapd.outputs.vmc.vmc_space import (
    VmcHeading,
    apply_heading,
    local_rotations,
    reflect_rotation,
    vmc_poses,
)
from mocapd.outputs.wire import Joint, Quaternion, SkeletonFrame, Vector

LEAF_CONFIDENCE = 0.05  # below, a leaf counts as untracked
MAX_LAYOUTS = 32  # cached packet layouts; leaves come and go
_UNEVEN = 1e-3  # by how much the squared length of a quaternion may differ from 1
_MOST = 1e6  # largest number that is sent; float32 holds far more
_HIPS = "hips"


class VmcEncoder:
    """avatar: of a file, None for the wearer's own bones.

    Before the first pose, `OK` reports `not loaded`, and no bone is sent. When the person is lost the last pose stays:
    without some of its bones a receiver collapses its avatar.
    """

    def __init__(
        self, heading: VmcHeading, mirror: bool, bundling: Bundling, avatar: Avatar | None
    ) -> None:
        self._heading, self._mirror, self._bundling = heading, mirror, bundling
        self._file_avatar = avatar
        self._body: _Body | None = None
        self._layouts: dict[tuple[int, ...], tuple[VmcPackets, tuple[int, ...]]] = {}
        self._packets = VmcPackets((), bundling)
        self._is_posed = False

    def encode(
        self,
        frame: SkeletonFrame,
        rest: RestSkeleton | None,
        *,
        calibration: int,
        time_s: float,
    ) -> list[bytearray]:
        """The datagrams of the frame; they are overwritten by the next call.

        rest: the person's skeleton, None while it is unknown; a skeleton without hips above the floor counts as None.
        calibration: VMC's state, 3 when calibrated. VMC's tracking state is good only in `live` frames.
        """
        pose = rest is not None and self._pose(frame, rest)
        self._packets.say(self._is_posed, calibration, pose and frame.tracking == "live", time_s)
        return self._packets.datagrams

    def _pose(self, frame: SkeletonFrame, rest: RestSkeleton) -> bool:
        """Write the frame's pose into the datagrams; False where the frame has no valid pose."""
        if _HIPS not in frame.joints or not _has_hips(rest):
            return False
        body = self._body
        if body is None or body.rest is not rest:
            body = self._body = _body(rest, self._file_avatar, self._mirror)
            self._layouts.clear()
        if not body.is_sane:
            return False
        joints = [frame.joints.get(name) for name in body.sources]
        hips_m = frame.joints[_HIPS].p
        # for the wearer's own bones the frame has the local rotations already
        sent = [joint.l for joint in joints if joint is not None] if body.is_own else []
        has_locals = len(sent) == len(joints)
        turns_xyzw = sent if has_locals else _global_rotations(joints, body.avatar.parents)
        if not all(map(_is_rotation, turns_xyzw)):
            return False
        if self._mirror:
            hips_m, turns_xyzw = reflect_position(hips_m), [*map(reflect_rotation, turns_xyzw)]
        if has_locals:
            locals_xyzw = apply_heading(self._heading, turns_xyzw)
        else:
            locals_xyzw = local_rotations(body.avatar, self._heading, turns_xyzw)
        numbers = vmc_poses(body.avatar, self._heading, hips_m, locals_xyzw, body.scale)
        if not all(_is_near(row[:3]) for row in numbers[:2]):  # root and hips; the others stay
            return False
        packets, rows = self._layout(
            body, tuple(k for k in body.leaves if not _is_tracked(joints[k]))
        )
        packets.pose([numbers[k] for k in rows])
        self._packets, self._is_posed = packets, True
        return True

    def _layout(
        self, body: "_Body", left_out: tuple[int, ...]
    ) -> tuple[VmcPackets, tuple[int, ...]]:
        """The datagrams without these bones, and the indices of the numbers in them."""
        layout = self._layouts.get(left_out)
        if layout is None:
            if len(self._layouts) >= MAX_LAYOUTS:
                self._layouts.clear()
            names = body.avatar.names
            sent = [k for k in range(len(names)) if k not in left_out]
            packets = VmcPackets([names[k] for k in sent], self._bundling)
            layout = self._layouts[left_out] = packets, (0, *(k + 1 for k in sent))
        return layout


@dataclass(frozen=True, slots=True, eq=False)
class _Body:
    """The body that is sent. is_own: it has the wearer's bones, perhaps mirrored; is_sane: all offsets are in range;
    sources: for each bone the joint of the frame that rotates it; leaves: indices of the leaf bones."""

    rest: RestSkeleton
    avatar: Avatar
    is_own: bool
    is_sane: bool
    scale: float
    sources: tuple[str, ...]
    leaves: tuple[int, ...]


def _body(rest: RestSkeleton, file_avatar: Avatar | None, mirror: bool) -> _Body:
    own = wearer_avatar(rest)
    avatar = file_avatar or (mirror_avatar(own) if mirror else own)
    return _Body(
        rest,
        avatar,
        file_avatar is None,
        all(map(_is_near, avatar.offsets_m)),
        avatar.hips_height_m / own.hips_height_m,
        tuple(map(other_side, avatar.names)) if mirror else avatar.names,
        tuple(k for k, name in enumerate(avatar.names) if is_leaf(name)),
    )


def _has_hips(rest: RestSkeleton) -> bool:
    """True if the first bone is the hips, above the floor."""
    return rest.names[:1] == (_HIPS,) and rest.offsets_m[0][1] > 0.0


def _is_tracked(joint: Joint | None) -> bool:
    return joint is not None and joint.c >= LEAF_CONFIDENCE


def _global_rotations(joints: list[Joint | None], parents: tuple[int, ...]) -> list[Quaternion]:
    """Global rotations; a bone that is missing in the frame rotates with its parent."""
    rows: list[Quaternion] = []
    for joint, parent in zip(joints, parents, strict=True):
        rows.append(joint.r if joint is not None else rows[parent])
    return rows


def _is_near(position_m: Vector) -> bool:
    """False also for NaN."""
    return all(abs(along_m) <= _MOST for along_m in position_m)


def _is_rotation(xyzw: Quaternion) -> bool:
    """False also for NaN."""
    x, y, z, w = xyzw
    return abs(x * x + y * y + z * z + w * w - 1.0) <= _UNEVEN
