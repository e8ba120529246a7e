"""Which sessions without the shirt are recorded: whole bodies in plain clothes, many before a pair 12 cm apart.

As the other plan, it follows from the names of the clips alone: half of the sessions are of clips whose names tell
of legs or of turning, the rest are spread over all others.
"""

from collections.abc import Sequence
from itertools import cycle

import msgspec
import numpy as np

from lab.simulated.motion_clip import MotionClip, Placement, within
from lab.simulated.session_plan import (
    BLEND_S,
    EMPTY_S,
    LAMP_OFF_S,
    SECONDS,
    STAND_S,
    PlannedSession,
    RigPlan,
    is_wide,
    planned_cameras,
)
from lab.simulated.variation import (
    Variation,
    varied_body,
    varied_clothes,
    varied_lights,
)
from mocapd.sim.person_spec import Bystander, MotionSpec, PoseKeyframe
from mocapd.sim.scenario import Scenario, Thing

PLAIN_SESSIONS = 20
MOST_WAY_M = 2.2
_LOOK_AT_M = (0.0, 0.92, 0.0)
# of whole-body motion, in the names of the public collections of clips
_LEG_WORDS = (
    "squat",
    "kick",
    "jog",
    "jump",
    "hop",
    "soccer",
    "elbowtoknee",
    "walk",
    "turn",
    "sneak",
    "deposit",
)


PLAIN_RIGS = (
    RigPlan("stereo", (0.0,), 3.2, 1.35, stereo=True),
    RigPlan("pair", (-35.0, 38.0), 3.2, 1.35),
    RigPlan("stereo", (18.0,), 3.3, 1.2, stereo=True),
    RigPlan("around", (-40.0, 50.0, 140.0, 225.0), 3.5, 1.7, outdoors_or_hall=True),
    RigPlan("stereo", (-12.0,), 3.0, 1.5, stereo=True),
    RigPlan("pair", (-20.0, 30.0), 3.3, 1.35),
    RigPlan("stereo", (6.0,), 3.4, 1.35, outdoors_or_hall=True, stereo=True),
    RigPlan("three", (-45.0, 0.0, 42.0), 3.1, 1.35),
)
_YAWS_DEG = (
    0.0,
    20.0,
    -35.0,
    10.0,
    50.0,
    -15.0,
    30.0,
)  # nobody begins with the back to the cameras
_STANCES = ("relaxed", "relaxed", "t_pose")


def plain_plan(clips: Sequence[MotionClip], scenes: Sequence[Scenario]) -> list[PlannedSession]:
    """The sessions, by number; fewer when few clips are long enough and stay in one place."""
    clip_s = SECONDS - EMPTY_S - STAND_S - BLEND_S
    starts = [(clip, within(clip, clip_s, MOST_WAY_M)) for clip in clips]
    usable = [(clip, begin) for clip, begin in starts if begin is not None]
    legs = [one for one in usable if any(word in one[0].name.lower() for word in _LEG_WORDS)]
    others = [one for one in usable if one not in legs]
    chosen = _spread(legs, PLAIN_SESSIONS // 2)
    chosen = _in_turn(chosen, _spread(others, PLAIN_SESSIONS - len(chosen)))
    rooms, halls = cycle(scenes), cycle([scene for scene in scenes if is_wide(scene)] or scenes)
    sessions = []
    for number, (clip, begin) in enumerate(chosen):
        rig = PLAIN_RIGS[number % len(PLAIN_RIGS)]
        scene = next(halls if rig.outdoors_or_hall else rooms)
        yaw_deg, stance = _YAWS_DEG[number % len(_YAWS_DEG)], _STANCES[number % len(_STANCES)]
        where = Placement(
            begin,
            round(clip_s * clip.rate_hz),
            yaw_deg,
            EMPTY_S + STAND_S,
            BLEND_S,
            stance,
        )
        name = f"plain{number:02d}_{rig.name}_{scene.name}_{clip.name}"
        scenario = plain_scenario(name, number, scene, rig, where)
        sessions.append(PlannedSession(name, scenario, clip, where))
    return sessions


def _in_turn(
    a: list[tuple[MotionClip, int]], b: list[tuple[MotionClip, int]]
) -> list[tuple[MotionClip, int]]:
    """Three of one, three of the other, so that every rig gets of both."""
    longest = max(len(a), len(b))
    return [one for i in range(0, longest, 3) for one in (*a[i : i + 3], *b[i : i + 3])]


def _spread(usable: list[tuple[MotionClip, int]], most: int) -> list[tuple[MotionClip, int]]:
    """At most so many, evenly over the list."""
    picked = np.unique(np.linspace(0, len(usable) - 1, most).round().astype(int))
    return [usable[i] for i in picked.tolist()] if usable else []


def plain_scenario(
    name: str, number: int, scene: Scenario, rig: RigPlan, where: Placement
) -> Scenario:
    """The scene with another body in plain clothes, other cameras and lights; number: of the variation."""
    vary = Variation(np.random.default_rng([2027, number]))
    body = varied_body(
        vary, whole=True, thigh_length=vary(0.02), shank_length=vary(0.02), hip_width=vary(0.04),
        leg_girth=vary(0.06), head_size=vary(0.02),
    )  # fmt: skip
    stance = PoseKeyframe(t_s=0.0, pose=where.stance, yaw_deg=where.yaw_deg)
    behind = is_wide(scene) and number % 3 == 0
    return msgspec.structs.replace(
        scene,
        name=name,
        seed=2000 + number,
        loop_s=SECONDS,
        scribble_s=0.2,
        person_appears_s=EMPTY_S,
        cameras=planned_cameras(scene, rig, vary, _LOOK_AT_M),
        body=body,
        clothes=varied_clothes(vary, number),
        lights=varied_lights(scene, vary, LAMP_OFF_S if number % 4 == 3 else None),
        motion=MotionSpec(keyframes=[stance], sway_deg=0.0),
        others=(_walks_behind(vary, number),) if behind else (),
        room=msgspec.structs.replace(
            scene.room, things=(*scene.room.things, *_portrait(scene, number))
        ),
    )


def _walks_behind(vary: Variation, number: int) -> Bystander:
    """Somebody who crosses the background to and fro."""
    z = -2.4 + 0.2 * float(vary.rng.normal())
    keys = [
        PoseKeyframe(t_s=0.0, at_m=(-1.6, z), yaw_deg=90.0),
        PoseKeyframe(t_s=2.9, at_m=(1.4, z), yaw_deg=90.0),
        PoseKeyframe(t_s=3.6, at_m=(1.5, z), yaw_deg=270.0),
        PoseKeyframe(t_s=6.3, at_m=(-1.5, z), yaw_deg=270.0),
    ]
    body = varied_body(vary, whole=True)
    return Bystander(
        body=body, motion=MotionSpec(keyframes=keys), clothes=varied_clothes(vary, number + 5)
    )


def _portrait(scene: Scenario, number: int) -> list[Thing]:
    """A face on paper on the wall behind, in some of the rooms."""
    room = scene.room
    if room.outdoors or number % 3 != 1:
        return []
    z = room.middle_m[1] - 0.5 * room.size_m[2] + 0.02
    return [
        Thing(
            kind="portrait",
            base_m=(-0.45, 1.25, z),
            size_m=(0.55, 0.75, 0.02),
            srgb=(206, 200, 188),
        )
    ]
