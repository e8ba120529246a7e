"""The scenario file: one TOML from which everything the simulated webcams show follows."""

import difflib
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Literal

import msgspec

from mocapd.body.skeleton import INDEX
from mocapd.boundary.files import read_text
from mocapd.boundary.numbers import check_numbers
from mocapd.boundary.parsing import convert, parse_toml
from mocapd.errors import ConfigError, MalformedError
from mocapd.sim.person.poses import POSES
from mocapd.sim.person_spec import (
    BodySpec,
    Bystander,
    Clothes,
    MotionSpec,
)
from mocapd.sim.scenario_values import (
    Fraction,
    Name,
    NotNegative,
    Number,
    Pixels,
    Positive,
    Span,
    Srgb,
    Table,
    Vec2,
    Vec3,
)

_MOST_BYTES = 64_000  # ours have 5 kB at most


class CameraSpec(Table, frozen=True, kw_only=True):
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
    outages: tuple[Span, ...] = ()  # when it is unplugged


class LightEvent(Table, frozen=True, kw_only=True):
    """From `t_s` on the light burns at `level` of its intensity, reached after `over_s`."""

    t_s: NotNegative
    level: NotNegative
    over_s: Positive = 0.03


class Light(Table, frozen=True, kw_only=True):
    """A lamp. The level at the start of the loop is that of the last event, so that it closes."""

    name: Name
    position_m: Vec3
    colour: Vec3  # linear R G B
    intensity: NotNegative  # irradiance [signal] at 1 m, or everywhere when it is a sun
    radius_m: NotNegative = 0.08  # softness of the shadows
    sun: bool = False  # far away: parallel light without falloff, `position_m` is its direction
    events: tuple[LightEvent, ...] = ()


class Ambient(Table, frozen=True, kw_only=True):
    """Light from everywhere; `up` falls from above, `down` is what the floor gives back."""

    up: Vec3 = (0.20, 0.20, 0.20)
    down: Vec3 = (0.10, 0.09, 0.08)


class SurfaceSpec(Table, frozen=True, kw_only=True):
    """A wall, floor or ceiling."""

    srgb: Srgb
    pattern: Literal["plain", "plaster", "planks", "checks", "grass", "bricks"] = "plain"


class Thing(Table, frozen=True, kw_only=True):
    """A piece of furniture: middle of its base, extent along x y z before it is turned."""

    kind: Literal["box", "ball", "bookshelf", "table", "poster", "portrait", "sofa", "tree"] = "box"
    base_m: Vec3
    size_m: tuple[Positive, Positive, Positive]
    yaw_deg: Number = 0.0
    srgb: Srgb = (150, 140, 130)
    pattern: Literal["plain", "plaster", "planks", "checks", "grass", "bricks"] = "plain"
    glow: NotNegative = 0.0  # brightness of a lampshade, in the colour and at the level of `lamp`
    lamp: str = ""


class Room(Table, frozen=True, kw_only=True):
    """The background. Outdoors there is only the floor, under a sky; walls and ceiling are ignored."""

    outdoors: bool = False
    size_m: Vec3 = (6.0, 2.6, 6.0)
    middle_m: Vec2 = (0.0, 0.0)  # x, z of the middle of the floor
    walls: SurfaceSpec = SurfaceSpec(srgb=(188, 182, 170), pattern="plaster")
    floor: SurfaceSpec = SurfaceSpec(srgb=(150, 110, 72), pattern="planks")
    ceiling: SurfaceSpec = SurfaceSpec(srgb=(220, 218, 212))
    sky: Vec3 = (0.45, 0.62, 0.95)  # linear R G B, of pixels without an object
    things: tuple[Thing, ...] = ()


class Scenario(Table, frozen=True, kw_only=True):
    """A whole scenario file."""

    name: Name
    seed: Annotated[int, msgspec.Meta(ge=0, le=2**31 - 1)] = 0
    fps_hz: Annotated[float, msgspec.Meta(ge=1.0, le=1000.0)] = 30.0
    loop_s: Annotated[float, msgspec.Meta(gt=0.2, le=120.0)] = 12.0
    person_appears_s: NotNegative = 0.0  # recordings show an empty room until then
    absences: tuple[Span, ...] = ()  # when the person is not there, best while out of every picture
    scribble_s: NotNegative = 0.0  # instant of the picture that the user labels with strokes
    jpeg_quality: Annotated[int, msgspec.Meta(ge=40, le=100)] = 88
    cameras: Annotated[list[CameraSpec], msgspec.Meta(min_length=1, max_length=32)]
    body: BodySpec = BodySpec()
    motion: MotionSpec
    clothes: Clothes = Clothes()
    others: Annotated[tuple[Bystander, ...], msgspec.Meta(max_length=4)] = ()
    lights: tuple[Light, ...] = ()
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
    """Of every table of the file: they are in this module and in `person_spec`."""
    return sorted({name for table in Table.__subclasses__() for name in table.__struct_fields__})


def _check(s: Scenario, where: str) -> None:
    """Checks across values: references between names, times inside the loop."""
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
    _check_motion(s.motion, s.loop_s, f"{where}, motion")
    _check_clothes(s.clothes, s.loop_s, f"{where}, clothes")
    for i, other in enumerate(s.others):
        key = f"{where}, others[{i}]"
        _check_motion(other.motion, s.loop_s, f"{key}.motion")
        _check_clothes(other.clothes, s.loop_s, f"{key}.clothes")
    _check_spans(s.absences, s.loop_s, f"{where}, absences")
    for i, camera in enumerate(s.cameras):
        _check_spans(camera.outages, s.loop_s, f"{where}, cameras[{i}].outages")
    lamps = [light.name for light in s.lights]
    for i, light in enumerate(s.lights):
        _check_events([e.t_s for e in light.events], s.loop_s, f"{where}, lights[{i}].events")
    for i, thing in enumerate(s.room.things):
        if thing.lamp and thing.lamp not in lamps:
            raise ConfigError(
                f"no light is named {thing.lamp!r}",
                f"{where}, room.things[{i}].lamp",
                f"use one of {lamps}",
            )


def _check_events(times_s: list[float], loop_s: float, where: str) -> None:
    if times_s != sorted(times_s) or any(t >= loop_s for t in times_s):
        raise ConfigError("the times do not rise inside the loop", where, "sort them")


def _check_clothes(clothes: Clothes, loop_s: float, where: str) -> None:
    _check_events([event.t_s for event in clothes.events], loop_s, f"{where}.events")
    if clothes.events and clothes.jacket is None:
        raise ConfigError("there is no jacket to put on", f"{where}.events", f"add {where}.jacket")


def _check_spans(spans: Sequence[Span], loop_s: float, where: str) -> None:
    if any(not span.from_s < span.to_s <= loop_s for span in spans):
        raise ConfigError("from_s < to_s <= loop_s does not hold", where, "change the times")


def _check_motion(motion: MotionSpec, loop_s: float, where: str) -> None:
    times = [key.t_s for key in motion.keyframes]
    if any(b <= a for a, b in pairwise(times)) or times[-1] >= loop_s:
        raise ConfigError(
            "the times do not rise inside the loop", f"{where}.keyframes", "sort them"
        )
    for i, key in enumerate(motion.keyframes):
        if key.pose not in POSES:
            raise ConfigError(
                f"unknown pose {key.pose!r}",
                f"{where}.keyframes[{i}].pose",
                f"use one of {sorted(POSES)}",
            )
    for i, swing in enumerate(motion.oscillations):
        if swing.joint not in INDEX:
            raise ConfigError(
                f"unknown joint {swing.joint!r}",
                f"{where}.oscillations[{i}].joint",
                f"use one of {sorted(INDEX)}",
            )
        if not swing.from_s < swing.to_s <= loop_s:
            raise ConfigError(
                "from_s < to_s <= loop_s does not hold",
                f"{where}.oscillations[{i}]",
                "change the times",
            )
