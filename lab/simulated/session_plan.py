"""Which sessions are recorded: clips, bodies, clothes, rooms, lights and rigs, each other than the one before.

A plan follows from the names of the clips alone, so that two machines record the same.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle

import msgspec
import numpy as np

from lab.simulated.motion_clip import MotionClip, Placement, within
from lab.simulated.variation import Variation, stereo_pair, varied_body, varied_lights
from mocapd.sim.person_spec import MotionSpec, PoseKeyframe
from mocapd.sim.scenario import CameraSpec, Scenario
from mocapd.sim.scenario_values import Vec3

SESSIONS = 24
SECONDS = 7.0
EMPTY_S, STAND_S, BLEND_S = 0.67, 0.5, 0.67  # before the clip, as in recorded captures
LAMP_OFF_S = 4.2
_MOST_WAY_M = 1.6  # that the clips' person goes; the cameras stand where they see all of it
_LOOK_AT_M = (0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class RigPlan:
    """Where the cameras stand. azimuths_deg: about the person, 0 is in front of it; of a stereo pair, 12 cm apart, the
    middle's; from how far, how high."""

    name: str
    azimuths_deg: tuple[float, ...]
    distance_m: float = 2.8
    height_m: float = 1.4
    outdoors_or_hall: bool = False  # too wide for a living room
    stereo: bool = False


RIGS = (
    RigPlan("pair", (-32.0, 34.0)),
    RigPlan("around", (-40.0, 50.0, 140.0, 225.0), 3.1, 1.7, outdoors_or_hall=True),
    RigPlan("pair", (-25.0, 28.0), 2.6),
    RigPlan("narrow", (-1.3, 1.3), 2.7),
    RigPlan("pair", (-45.0, 40.0), 2.7),
    RigPlan("three", (-50.0, 0.0, 45.0), 2.7),
    RigPlan("pair", (-30.0, 60.0), 2.8),
    RigPlan("one", (8.0,), 2.9),
)
YAWS_DEG = (
    0.0,
    35.0,
    -50.0,
    15.0,
    -20.0,
    70.0,
    -80.0,
)  # a side is hidden from a pair at the larger ones


@dataclass(frozen=True, slots=True, eq=False)
class PlannedSession:
    """One session to be recorded, as long as the scenario's loop. clip, where: what the person does, in place of
    the scenario's motion; clear_s: from when on nothing stands in a tracker's way any more, where that is known."""

    name: str
    scenario: Scenario
    clip: MotionClip | None = None
    where: Placement | None = None
    clear_s: float | None = None


def plan(clips: Sequence[MotionClip], scenes: Sequence[Scenario]) -> list[PlannedSession]:
    """The sessions, by number; fewer when few clips are long enough and stay in one place."""
    clip_s = SECONDS - EMPTY_S - STAND_S - BLEND_S
    starts = [(clip, within(clip, clip_s, _MOST_WAY_M)) for clip in clips]
    usable = [(clip, begin) for clip, begin in starts if begin is not None]
    picked = np.unique(np.linspace(0, len(usable) - 1, SESSIONS).round().astype(int)).tolist()
    wide = [scene for scene in scenes if is_wide(scene)]
    rooms, halls = cycle(scenes), cycle(wide or scenes)
    sessions = []
    for number, which in enumerate(picked if usable else ()):
        clip, begin = usable[which]
        rig = RIGS[number % len(RIGS)]
        scene = next(halls if rig.outdoors_or_hall else rooms)
        where = Placement(
            begin,
            round(clip_s * clip.rate_hz),
            YAWS_DEG[number % len(YAWS_DEG)],
            EMPTY_S + STAND_S,
            BLEND_S,
        )
        name = f"{number:02d}_{rig.name}_{scene.name}_{clip.name}"
        sessions.append(
            PlannedSession(name, _scenario(name, number, scene, rig, where), clip, where)
        )
    return sessions


def is_wide(scene: Scenario) -> bool:
    """Whether cameras have room all around."""
    return scene.room.outdoors or min(scene.room.size_m[::2]) > 8.0


def planned_cameras(
    scene: Scenario, rig: RigPlan, vary: Variation, look_at_m: Vec3
) -> list[CameraSpec]:
    """Like the scene's first camera, at other places; a stereo pair is rigid and exposes together."""
    seen, out = scene.cameras[0], list[CameraSpec]()
    for k, azimuth_deg in enumerate(rig.azimuths_deg):
        azimuth_rad, away_m = np.radians(azimuth_deg), rig.distance_m * vary(0.03)
        camera = msgspec.structs.replace(
            seen, name=f"cam{k}",
            position_m=(
                float(away_m * np.sin(azimuth_rad)), rig.height_m * vary(0.05), float(away_m * np.cos(azimuth_rad)),
            ),
            look_at_m=look_at_m, roll_deg=float(vary.rng.normal(0.0, 1.0)), focal_px=None, centre_px=None,
            fov_deg=float(vary.rng.uniform(56.0, 64.0)), dropped=0.0, gain=seen.gain * vary(0.05),
            clock_offset_s=0.0 if k == 0 else float(vary.rng.uniform(0.0, 0.016)),
        )  # fmt: skip
        out.append(camera)
    return stereo_pair(out[0]) if rig.stereo else out


def _scenario(name: str, number: int, scene: Scenario, rig: RigPlan, where: Placement) -> Scenario:
    rng = np.random.default_rng([2026, number])
    vary = Variation(rng)
    body, cameras = varied_body(vary), planned_cameras(scene, rig, vary, _LOOK_AT_M)
    lights = varied_lights(scene, vary, LAMP_OFF_S if number % 3 == 1 else None)
    clothes = msgspec.structs.replace(scene.clothes, dye_variation=0.03 + 0.02 * rng.uniform())
    stance = PoseKeyframe(t_s=0.0, pose="t_pose", yaw_deg=where.yaw_deg)
    return msgspec.structs.replace(
        scene, name=name, seed=1000 + number, loop_s=SECONDS, scribble_s=0.2, person_appears_s=EMPTY_S,
        cameras=cameras, body=body, clothes=clothes, lights=lights, motion=MotionSpec(keyframes=[stance], sway_deg=0.0),
    )  # fmt: skip
