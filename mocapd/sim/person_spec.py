"""The people of a scenario file: their bodies, what they do, and what they wear."""

from typing import Annotated, Literal

import msgspec

from mocapd.sim.scenario_values import (
    Fraction,
    NotNegative,
    Number,
    Positive,
    Ratio,
    Srgb,
    Table,
    Vec2,
    Vec3,
)


class BodySpec(Table, frozen=True, kw_only=True):
    """The person: stature, and factors on the mean body of that stature.

    whole: with shaped legs, feet with toes and a face of eyes, nose and mouth, for what tracks them; else
    the legs are rough and the face is smooth, and the factors of legs and head have no effect.
    """

    stature_m: Annotated[float, msgspec.Meta(ge=0.8, le=2.3)] = 1.75
    torso_length: Ratio = 1.0
    shoulder_width: Ratio = 1.0
    upper_arm_length: Ratio = 1.0
    forearm_length: Ratio = 1.0
    torso_width: Ratio = 1.0
    torso_depth: Ratio = 1.0
    arm_girth: Ratio = 1.0
    whole: bool = False
    thigh_length: Ratio = 1.0
    shank_length: Ratio = 1.0
    hip_width: Ratio = 1.0
    leg_girth: Ratio = 1.0
    head_size: Ratio = 1.0


class PoseKeyframe(Table, frozen=True, kw_only=True):
    """A pose that the motion passes through. Arm directions are in the frame of the chest.

    left_foot_m, right_foot_m: offset of the ankle from its place in the upright pose, in the frame of the hips:
    to the person's left, up, forwards [m]; when absent, the foot stands and steps by itself.
    """

    t_s: NotNegative
    pose: str = "relaxed"
    at_m: Vec2 | None = None  # x, z of the hips on the floor; as in the keyframe before when absent
    yaw_deg: Number | None = None  # about +Y, 0 faces +Z; as in the keyframe before when absent
    lean_deg: Vec2 = (0.0, 0.0)  # forwards, to the person's left
    twist_deg: Number = 0.0  # of the chest against the hips, to the person's left
    left_arm: tuple[Vec3, Vec3] | None = None  # directions of upper arm and forearm
    right_arm: tuple[Vec3, Vec3] | None = None
    left_foot_m: Vec3 | None = None
    right_foot_m: Vec3 | None = None


class Oscillation(Table, frozen=True, kw_only=True):
    """A joint that swings about its keyframed rotation between two times of the loop."""

    joint: str
    amplitude_deg: Vec3  # rotation vector in the parent bone's frame
    frequency_hz: Positive
    from_s: NotNegative
    to_s: Positive


class MotionSpec(Table, frozen=True, kw_only=True):
    """What the person does in one loop; the end runs into the beginning without a jump."""

    keyframes: Annotated[list[PoseKeyframe], msgspec.Meta(min_length=1)]
    oscillations: tuple[Oscillation, ...] = ()
    sway_deg: NotNegative = 1.0  # slow movement of an upright person


class Weave(Table, frozen=True, kw_only=True):
    """A second colour in a cloth: stripes around the trunk and arms and along the legs, checks, or a print
    on the chest. period_m: from one stripe to the next."""

    pattern: Literal["plain", "stripes", "checks", "print"] = "plain"
    srgb: Srgb = (232, 230, 222)
    period_m: Positive = 0.07


class Jacket(Table, frozen=True, kw_only=True):
    """Worn over everything from the neck to below the hips, with long sleeves and a zip."""

    srgb: Srgb = (58, 66, 82)
    weave: Weave = Weave()
    thickness_m: Fraction = 0.012


class ClothesEvent(Table, frozen=True, kw_only=True):
    """From `t_s` on the jacket goes to where `jacket` says within `over_s`: 0 off, 1 on. Its border moves over
    the body from the right cuff to the left one, and back when it is taken off."""

    t_s: NotNegative
    jacket: Fraction
    over_s: Positive = 1.5


class Clothes(Table, frozen=True, kw_only=True):
    """Dyes and cloth. `dye_variation`: how far the printed colours are off the standard's.

    shirt: the one that is tracked, or a plain one in `top_srgb`. A jacket without events is always worn; with
    events it is, at the start of the loop, as the last one left it, so that the loop closes.
    """

    shirt: Literal["standard-v1", "plain"] = "standard-v1"
    dye_variation: NotNegative = 0.03
    wrinkles_m: NotNegative = 0.006
    top_srgb: Srgb = (132, 138, 146)
    top_weave: Weave = Weave()
    sleeves: Literal["long", "short"] = "long"  # of the plain one
    trousers_srgb: Srgb = (70, 72, 84)
    trousers_weave: Weave = Weave()
    skin_srgb: Srgb = (196, 150, 122)
    hair_srgb: Srgb = (52, 38, 30)
    shoes_srgb: Srgb = (40, 40, 44)
    jacket: Jacket | None = None
    events: tuple[ClothesEvent, ...] = ()


class Screen(Table, frozen=True, kw_only=True):
    """A television: the middle of its lower edge, its height, how much height of a scene it shows [m], and which way it
    faces, 0 +Z."""

    base_m: Vec3
    height_m: Positive
    shows_m: Positive = 2.0
    yaw_deg: Number = 0.0


class Bystander(Table, frozen=True, kw_only=True):
    """Another, untracked person in the picture, without a shadow. screen: that shows the person, instead of
    the room."""

    body: BodySpec = BodySpec()
    motion: MotionSpec
    clothes: Clothes = Clothes(shirt="plain")
    screen: Screen | None = None
