"""Named poses of the scenario language: directions of the limbs in the frame of the chest."""

from dataclasses import dataclass

Direction = tuple[float, float, float]
ArmDirections = tuple[Direction, Direction]


@dataclass(frozen=True, slots=True)
class NamedPose:
    """Directions of upper arm and forearm, +X the person's left, +Y up, +Z forward; any length.

    `bend_deg` bends the spine forwards, `crouch_m` lowers the hips.
    """

    left: ArmDirections
    right: ArmDirections
    bend_deg: float = 0.0
    crouch_m: float = 0.0


def _mirror(arm: ArmDirections) -> ArmDirections:
    (ux, uy, uz), (fx, fy, fz) = arm
    return (-ux, uy, uz), (-fx, fy, fz)


def _both(arm: ArmDirections, bend_deg: float = 0.0, crouch_m: float = 0.0) -> NamedPose:
    return NamedPose(arm, _mirror(arm), bend_deg, crouch_m)


_DOWN: ArmDirections = ((0.20, -1.0, -0.02), (0.12, -1.0, 0.22))
_OUT: ArmDirections = ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
_UP: ArmDirections = ((0.45, 1.0, 0.05), (0.12, 1.0, 0.10))
_GOALPOST: ArmDirections = ((1.0, 0.0, 0.0), (0.10, 1.0, 0.12))
_FORWARD: ArmDirections = ((0.10, -0.05, 1.0), (0.02, 0.0, 1.0))
_WAVE: ArmDirections = ((0.85, -0.25, 0.30), (0.25, 1.0, 0.25))
_HIP: ArmDirections = ((0.65, -0.80, -0.20), (-0.55, -0.75, 0.30))
_CROSS_HIGH: ArmDirections = ((0.12, -0.62, 0.75), (-1.0, 0.25, 0.30))
_CROSS_LOW: ArmDirections = ((0.12, -0.80, 0.55), (-1.0, 0.02, 0.42))
_REACH: ArmDirections = ((0.35, 0.55, 0.80), (0.10, 0.75, 0.75))
_GUARD: ArmDirections = ((0.25, -0.75, 0.50), (-0.10, 0.80, 0.70))
_BELLY: ArmDirections = ((0.32, -0.95, 0.12), (-0.75, -0.05, 0.70))
_CLAP: ArmDirections = ((0.35, -0.25, 0.90), (-0.42, 0.10, 0.95))
_DIAGONAL_UP: ArmDirections = ((1.0, 0.70, 0.05), (1.0, 0.80, 0.10))
_DIAGONAL_DOWN: ArmDirections = ((1.0, -0.80, 0.05), (1.0, -0.70, 0.15))

POSES = {
    "t_pose": _both(_OUT),
    "relaxed": _both(_DOWN),
    "arms_up": _both(_UP),
    "goalpost": _both(_GOALPOST),
    "arms_forward": _both(_FORWARD),
    "hands_on_hips": _both(_HIP),
    "guard": _both(_GUARD, crouch_m=0.06),
    "clap": _both(_CLAP),
    "star": _both(_DIAGONAL_UP),
    "wave_left": NamedPose(_WAVE, _mirror(_DOWN)),
    "wave_right": NamedPose(_DOWN, _mirror(_WAVE)),
    "crossed": NamedPose(_CROSS_HIGH, _mirror(_CROSS_LOW)),
    "reach_left": NamedPose(_REACH, _mirror(_DOWN)),
    "reach_right": NamedPose(_DOWN, _mirror(_REACH)),
    "archer": NamedPose(_OUT, _mirror(_CLAP)),
    "diagonal": NamedPose(_DIAGONAL_UP, _mirror(_DIAGONAL_DOWN)),
    "hand_on_belly": NamedPose(_DOWN, _mirror(_BELLY)),
    "bow": _both(((0.15, -0.9, 0.45), (0.05, -0.95, 0.35)), bend_deg=30.0, crouch_m=0.03),
    "lunge": NamedPose(_FORWARD, _mirror(_GOALPOST), bend_deg=8.0, crouch_m=0.10),
}
