"""The scenario file: one TOML from which everything the simulated webcams show follows."""

import difflib
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from mocapd.body.skeleton import INDEX
from mocapd.boundary.files import read_text
from mocapd.boundary.messages import convert, parse_toml
from mocapd.boundary.numbers import check_numbers
from mocapd.errors import ConfigError, MalformedError
from mocapd.sim.person.poses import POSES

_MOST_BYTES = 1 << 20

# in metres, degrees, seconds or signal: what is beyond these limits is no room that a camera shows
Number = Annotated[float, msgspec.Meta(ge=-1e4, le=1e4)]
Vec2 = tuple[Number, Number]
Vec3 = tuple[Number, Number, Number]
Srgb = tuple[
    Annotated[int, msgspec.Meta(ge=0, le=255)],
    Annotated[int, msgspec.Meta(ge=0, le=255)],
    Annotated[int, msgspec.Meta(ge=0, le=255)],
]
Positive = Annotated[float, msgspec.Meta(ge=1e-6, le=1e4)]
NotNegative = Annotated[float, msgspec.Meta(ge=0.0, le=1e4)]
Fraction = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
Ratio = Annotated[float, msgspec.Meta(ge=0.7, le=1.4)]
Name = Annotated[str, msgspec.Meta(pattern=r"^[A-Za-z0-9_-]+$", max_length=100)]
Pixels = Annotated[int, msgspec.Meta(ge=16, le=8192)]


class _Table(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of the file: frozen, and a key that is not a field is an error."""


class CameraSpec(_Table, frozen=True, kw_only=True):
    """One simulated webcam: where it stands, its lens, its sensor and its faults."""

    name: Name
    position_m: Vec3
    look_at_m: Vec3
    roll_deg: Number = 0.0
    size_px: tuple[Pixels, Pixels] = (640, 480)
    fov_deg: Annotated[float, msgspec.Meta(gt=5.0, lt=150.0)] = 54.0  # horizontal
    focal_px: tuple[Positive, Positive] | None = None  # fx, fy; in place of fov_deg
    centre_px: Vec2 | None = None  # cx, cy; the middle of the picture when absent
    dist: tuple[Number, Number, Number, Number, Number] = (
        0.0,
        0.0,
        0.0,
        0.0,
        0.0,
    )  # k1 k2 p1 p2 k3
    gamma: Positive = 2.2
    gain: Positive = 1.0
    white_balance: Vec3 = (1.0, 1.0, 1.0)  # gains of R G B, fixed as with automatic balance off
    shoulder: Fraction = 0.85  # linear signal above which the response bends towards clipping
    shutter_s: NotNegative = 0.010
    shot_noise: NotNegative = 0.012  # standard deviation at full signal, linear units
    read_noise: NotNegative = 0.003
    vignetting: Fraction = 0.12  # light lost in the corner
    clock_offset_s: Number = 0.0  # how much later than the first camera this one exposes
    dropped: Fraction = 0.0  # fraction of frames that never arrive


class BodySpec(_Table, frozen=True, kw_only=True):
    """The person: stature, and factors on the mean body of that stature."""

    stature_m: Annotated[float, msgspec.Meta(ge=0.8, le=2.3)] = 1.75
    torso_length: Ratio = 1.0
    shoulder_width: Ratio = 1.0
    upper_arm_length: Ratio = 1.0
    forearm_length: Ratio = 1.0
    torso_width: Ratio = 1.0
    torso_depth: Ratio = 1.0
    arm_girth: Ratio = 1.0


class PoseKeyframe(_Table, frozen=True, kw_only=True):
    """A pose that the motion passes through. Arm directions are in the frame of the chest."""

    t_s: NotNegative
    pose: str = "relaxed"
    at_m: Vec2 | None = None  # x, z of the hips on the floor; as in the keyframe before when absent
    yaw_deg: Number | None = None  # about +Y, 0 faces +Z; as in the keyframe before when absent
    lean_deg: Vec2 = (0.0, 0.0)  # forwards, to the person's left
    twist_deg: Number = 0.0  # of the chest against the hips, to the person's left
    left_arm: tuple[Vec3, Vec3] | None = None  # directions of upper arm and forearm
    right_arm: tuple[Vec3, Vec3] | None = None


class Oscillation(_Table, frozen=True, kw_only=True):
    """A joint that swings about its keyframed rotation between two times of the loop."""

    joint: str
    amplitude_deg: Vec3  # rotation vector in the parent bone's frame
    frequency_hz: Positive
    from_s: NotNegative
    to_s: Positive


class MotionSpec(_Table, frozen=True, kw_only=True):
    """What the person does in one loop; the end runs into the beginning without a jump."""

    keyframes: Annotated[list[PoseKeyframe], msgspec.Meta(min_length=1)]
    oscillations: list[Oscillation] = []
    sway_deg: NotNegative = 1.0  # slow movement of a person who stands


class Clothes(_Table, frozen=True, kw_only=True):
    """Dyes and cloth. `dye_variation`: how far the printed colours are off the standard's."""

    shirt: Literal["standard-v1"] = "standard-v1"
    dye_variation: NotNegative = 0.03
    wrinkles_m: NotNegative = 0.006
    trousers_srgb: Srgb = (70, 72, 84)
    skin_srgb: Srgb = (196, 150, 122)
    hair_srgb: Srgb = (52, 38, 30)
    shoes_srgb: Srgb = (40, 40, 44)


class LightEvent(_Table, frozen=True, kw_only=True):
    """From `t_s` on the light burns at `level` of its intensity, reached after `over_s`."""

    t_s: NotNegative
    level: NotNegative
    over_s: Positive = 0.03


class Light(_Table, frozen=True, kw_only=True):
    """A lamp. The level at the start of the loop is that of the last event, so that it closes."""

    name: Name
    position_m: Vec3
    colour: Vec3  # linear R G B
    intensity: NotNegative  # irradiance [signal] at 1 m, or everywhere when it is a sun
    radius_m: NotNegative = 0.08  # softness of the shadows
    sun: bool = False  # far away: parallel light without falloff, `position_m` is its direction
    events: list[LightEvent] = []


class Ambient(_Table, frozen=True, kw_only=True):
    """Light from everywhere; `up` falls from above, `down` is what the floor gives back."""

    up: Vec3 = (0.20, 0.20, 0.20)
    down: Vec3 = (0.10, 0.09, 0.08)


class SurfaceSpec(_Table, frozen=True, kw_only=True):
    """A wall, floor or ceiling."""

    srgb: Srgb
    pattern: Literal["plain", "plaster", "planks", "checks", "grass", "bricks"] = "plain"


class Thing(_Table, frozen=True, kw_only=True):
    """A piece of furniture: middle of its base, extent along x y z before it is turned."""

    kind: Literal["box", "ball", "bookshelf", "table", "poster", "sofa", "tree"] = "box"
    base_m: Vec3
    size_m: tuple[Positive, Positive, Positive]
    yaw_deg: Number = 0.0
    srgb: Srgb = (150, 140, 130)
    pattern: Literal["plain", "plaster", "planks", "checks", "grass", "bricks"] = "plain"
    glow: NotNegative = 0.0  # brightness of a lampshade, in the colour and at the level of `lamp`
    lamp: str = ""


class Room(_Table, frozen=True, kw_only=True):
    """The background. Outdoors there is only the floor, under a sky; walls and ceiling are ignored."""

    outdoors: bool = False
    size_m: Vec3 = (6.0, 2.6, 6.0)
    middle_m: Vec2 = (0.0, 0.0)  # x, z of the middle of the floor
    walls: SurfaceSpec = SurfaceSpec(srgb=(188, 182, 170), pattern="plaster")
    floor: SurfaceSpec = SurfaceSpec(srgb=(150, 110, 72), pattern="planks")
    ceiling: SurfaceSpec = SurfaceSpec(srgb=(220, 218, 212))
    sky: Vec3 = (0.45, 0.62, 0.95)  # linear R G B, seen where nothing stands
    things: list[Thing] = []


class Scenario(_Table, frozen=True, kw_only=True):
    """A whole scenario file."""

    name: Name
    seed: Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)] = 0
    fps_hz: Annotated[float, msgspec.Meta(ge=1.0, le=1000.0)] = 30.0
    loop_s: Annotated[float, msgspec.Meta(gt=0.2, le=120.0)] = 12.0
    person_appears_s: NotNegative = 0.0  # recordings show an empty room until then
    scribble_s: NotNegative = 0.0  # instant of the picture that the user labels with strokes
    jpeg_quality: Annotated[int, msgspec.Meta(ge=40, le=100)] = 88
    cameras: Annotated[list[CameraSpec], msgspec.Meta(min_length=1, max_length=32)]
    body: BodySpec = BodySpec()
    motion: MotionSpec
    clothes: Clothes = Clothes()
    lights: list[Light] = []
    ambient: Ambient = Ambient()
    room: Room = Room()


def load_scenario(path: Path) -> Scenario:
    """Read a scenario file. Raises InputError or ConfigError naming the file, the key and the fix."""
    text = read_text(path, _MOST_BYTES)
    try:
        table = parse_toml(text)
    except MalformedError as error:
        raise ConfigError(f"not valid TOML ({error.what})", str(path), "mend that line") from None
    return scenario_from_dict(table, str(path))


def scenario_from_dict(table: dict[str, object], where: str = "scenario") -> Scenario:
    """A scenario from the values of a TOML file. Raises ConfigError naming the key and the fix."""
    try:
        check_numbers(table)
        scenario: Scenario = convert(table, Scenario)
    except MalformedError as error:
        raise _config_error(error.what, where) from None
    _check(scenario, where)
    return scenario


def _config_error(message: str, where: str) -> ConfigError:
    """msgspec's "... - at `$.cameras[0].fov`" as key path, and the nearest key name as the fix."""
    what, _, path = message.partition(" - at `$")
    path = path.rstrip("`").lstrip(".")
    fix = f"change {path or 'it'}"
    if "unknown field" in what:
        key = what.split("`")[1]
        path = f"{path}.{key}" if path else key
        what = f"unknown key {key!r}"
        near = difflib.get_close_matches(key, _all_keys(), n=1)
        fix = f"did you mean {near[0]!r}?" if near else "remove it"
    elif "missing required field" in what:
        key = what.split("`")[1]
        path = f"{path}.{key}" if path else key
        what, fix = f"the key {key!r} is missing", f"add {path}"
    return ConfigError(what, f"{where}, {path}" if path else where, fix)


def _all_keys() -> list[str]:
    tables = (
        CameraSpec,
        BodySpec,
        PoseKeyframe,
        Oscillation,
        MotionSpec,
        Clothes,
        LightEvent,
        Light,
        Ambient,
    )
    tables += (SurfaceSpec, Thing, Room, Scenario)  # type: ignore[assignment]
    return sorted({name for table in tables for name in table.__struct_fields__})


def _check(s: Scenario, where: str) -> None:
    """What one value alone cannot tell: names that refer to others, times inside the loop."""
    names = [camera.name for camera in s.cameras]
    if len(set(names)) != len(names):
        raise ConfigError("two cameras have one name", f"{where}, cameras", "rename one of them")
    frames = s.loop_s * s.fps_hz
    if abs(frames - round(frames)) > 1e-6:
        raise ConfigError(
            f"a loop of {s.loop_s} s is not a whole number of frames at {s.fps_hz} Hz",
            f"{where}, loop_s",
            f"use {round(frames) / s.fps_hz:g}",
        )
    _check_motion(s, where)
    lamps = [light.name for light in s.lights]
    for i, light in enumerate(s.lights):
        times = [event.t_s for event in light.events]
        key = f"{where}, lights[{i}].events"
        if times != sorted(times) or any(t >= s.loop_s for t in times):
            raise ConfigError("the times do not rise inside the loop", key, "sort them")
    for i, thing in enumerate(s.room.things):
        if thing.lamp and thing.lamp not in lamps:
            raise ConfigError(
                f"no light is named {thing.lamp!r}",
                f"{where}, room.things[{i}].lamp",
                f"use one of {lamps}",
            )


def _check_motion(s: Scenario, where: str) -> None:
    times = [key.t_s for key in s.motion.keyframes]
    if any(b <= a for a, b in pairwise(times)) or times[-1] >= s.loop_s:
        raise ConfigError(
            "the times do not rise inside the loop", f"{where}, motion.keyframes", "sort them"
        )
    for i, key in enumerate(s.motion.keyframes):
        if key.pose not in POSES:
            raise ConfigError(
                f"unknown pose {key.pose!r}",
                f"{where}, motion.keyframes[{i}].pose",
                f"use one of {sorted(POSES)}",
            )
    for i, swing in enumerate(s.motion.oscillations):
        if swing.joint not in INDEX:
            raise ConfigError(
                f"unknown joint {swing.joint!r}",
                f"{where}, motion.oscillations[{i}].joint",
                f"use one of {sorted(INDEX)}",
            )
        if not swing.from_s < swing.to_s <= s.loop_s:
            raise ConfigError(
                "from_s < to_s <= loop_s does not hold",
                f"{where}, motion.oscillations[{i}]",
                "change the times",
            )
