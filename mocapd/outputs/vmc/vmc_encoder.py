"""From skeleton frames of one person to VMC datagrams."""

from dataclasses import dataclass

from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.vmc.avatar import Avatar, mirrored, reflected, wearer_avatar
from mocapd.outputs.vmc.bone_names import is_leaf, other_side
from mocapd.outputs.vmc.placing import Placing, headed, local_rotations, placed, reflected_turn
from mocapd.outputs.vmc.vmc_packets import Bundling, VmcPackets
from mocapd.outputs.wire import Joint, Quaternion, SkeletonFrame, Vector

LEAF_CONFIDENCE = 0.05  # below which a leaf is taken to be untracked
MAX_LAYOUTS = 32  # kept laid out; leaves come and go
_UNEVEN = 1e-3  # by how much the squared length of a quaternion may differ from 1
_MOST = 1e6  # of any number that is sent; float32 holds far more, an avatar does not
_HIPS = "hips"


class VmcEncoder:
    """avatar: of a file, None for the wearer's own bones.

    Until a first pose is known, `OK` says that nothing is loaded, and no bone is sent. When the person is lost the last
    pose stays: a receiver that is told of no bones, or of some only, collapses its avatar.
    """

    def __init__(
        self, placing: Placing, mirror: bool, bundling: Bundling, avatar: Avatar | None
    ) -> None:
        self._placing, self._mirror, self._bundling = placing, mirror, bundling
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

        rest: whose body the frame is of, None while nobody told; one without hips, or with hips on the floor, is none.
        calibration: VMC's state, 3 when calibrated. Tracking is said to be good in frames with evidence alone.
        """
        pose = rest is not None and self._pose(frame, rest)
        self._packets.say(self._is_posed, calibration, pose and frame.tracking == "live", time_s)
        return self._packets.datagrams

    def _pose(self, frame: SkeletonFrame, rest: RestSkeleton) -> bool:
        """Whether the frame has a pose that can be sent; then it is what the datagrams say."""
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
        # the wearer's own bones turn as the frame says already; the products are for an avatar with others
        known = [one.l for one in joints if one is not None] if body.is_own else []
        is_told = len(known) == len(joints)
        turns_xyzw = known if is_told else _turned(joints, body.avatar.parents)
        if not all(map(_is_rotation, turns_xyzw)):
            return False
        if self._mirror:
            hips_m, turns_xyzw = reflected(hips_m), [*map(reflected_turn, turns_xyzw)]
        if is_told:
            locals_xyzw = headed(self._placing, turns_xyzw)
        else:
            locals_xyzw = local_rotations(body.avatar, self._placing, turns_xyzw)
        numbers = placed(body.avatar, self._placing, hips_m, locals_xyzw, body.scale)
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
        """The datagrams without these bones, and which of all numbers are in them."""
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
    """Whose bones are sent. is_own: the wearer's, mirrored perhaps; is_sane: none is as far away as no bone is;
    sources: of each bone the joint of the frame that turns it; leaves: places of those that are."""

    rest: RestSkeleton
    avatar: Avatar
    is_own: bool
    is_sane: bool
    scale: float
    sources: tuple[str, ...]
    leaves: tuple[int, ...]


def _body(rest: RestSkeleton, file_avatar: Avatar | None, mirror: bool) -> _Body:
    own = wearer_avatar(rest)
    avatar = file_avatar or (mirrored(own) if mirror else own)
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
    """Above the floor, and first of the bones."""
    return rest.names[:1] == (_HIPS,) and rest.offsets_m[0][1] > 0.0


def _is_tracked(joint: Joint | None) -> bool:
    return joint is not None and joint.c >= LEAF_CONFIDENCE


def _turned(joints: list[Joint | None], parents: tuple[int, ...]) -> list[Quaternion]:
    """Global rotations; a bone that the frame does not know is turned as the one above it."""
    rows: list[Quaternion] = []
    for joint, parent in zip(joints, parents, strict=True):
        rows.append(joint.r if joint is not None else rows[parent])
    return rows


def _is_near(position_m: Vector) -> bool:
    """Not NaN either."""
    return all(abs(along_m) <= _MOST for along_m in position_m)


def _is_rotation(xyzw: Quaternion) -> bool:
    """Not NaN either."""
    x, y, z, w = xyzw
    return abs(x * x + y * y + z * z + w * w - 1.0) <= _UNEVEN
