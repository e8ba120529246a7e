"""Which sessions are recorded before cameras all around: kicks, squats, turns, work on the floor, some with a second person.

As the other plans, it follows from the names of the clips alone.
"""

from collections.abc import Sequence
from itertools import cycle

from lab.simulated.motion_clip import MotionClip, Placement, within
from lab.simulated.plain_plan import MOST_WAY_M, plain_scenario
from lab.simulated.session_plan import (
    BLEND_S,
    EMPTY_S,
    SECONDS,
    STAND_S,
    PlannedSession,
    RigPlan,
    is_wide,
)
from mocapd.sim.scenario import Scenario

RING_SESSIONS = 12
_FIRST_NUMBER = 100  # of the variations, after those of the other plan
_RIGS = (
    RigPlan("ring3", (-60.0, 55.0, 175.0), 3.4, 1.6),
    RigPlan("ring4", (-40.0, 50.0, 140.0, 225.0), 3.5, 1.7),
)
# of motion, in the names of the public collections of clips: two clips of each are taken
_WORDS = ("kick", "squat", "deposit", "jog", "elbowtoknee", "jumping", "soccer", "throw")
_YAWS_DEG = (0.0, 40.0, -75.0, 120.0, 15.0, 180.0, -30.0)


def ring_plan(clips: Sequence[MotionClip], scenes: Sequence[Scenario]) -> list[PlannedSession]:
    """The sessions, by number, three and four cameras in turn; fewer when few clips are long enough and stay in one place."""
    clip_s = SECONDS - EMPTY_S - STAND_S - BLEND_S
    starts = {clip.name: within(clip, clip_s, MOST_WAY_M) for clip in clips}
    named = [
        [one for one in clips if word in one.name.lower() and starts[one.name] is not None][:2]
        for word in _WORDS
    ]
    chosen = [one for of_word in named for one in of_word][:RING_SESSIONS]
    halls = cycle([scene for scene in scenes if is_wide(scene)])
    sessions = []
    for number, clip in enumerate(chosen):
        rig, scene = _RIGS[number % len(_RIGS)], next(halls)
        begin = starts[clip.name]
        assert begin is not None
        where = Placement(
            begin,
            round(clip_s * clip.rate_hz),
            _YAWS_DEG[number % len(_YAWS_DEG)],
            EMPTY_S + STAND_S,
            BLEND_S,
            "relaxed",
        )
        name = f"ring{number:02d}_{rig.name}_{scene.name}_{clip.name}"
        scenario = plain_scenario(name, _FIRST_NUMBER + number, scene, rig, where)
        sessions.append(PlannedSession(name, scenario, clip, where))
    return sessions
