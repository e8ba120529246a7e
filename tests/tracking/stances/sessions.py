"""Ten simulated sessions of people without the shirt who never stand, or show the back from the start."""

from dataclasses import dataclass
from pathlib import Path

import msgspec

from lab.simulated.export import export_capture
from lab.simulated.variation import stereo_pair
from mocapd.assets import asset_path
from mocapd.sim.person_spec import BodySpec, Clothes, MotionSpec, PoseKeyframe, Weave
from mocapd.sim.scenario import CameraSpec, Scenario, Thing, load_scenario
from mocapd.sim.world import World
from tests.tracking.stances.low_stances import STANCES, hips_height_m, performed

SECONDS, EMPTY_S = 4.6, 0.8
_FROM_HIPS_M = 0.10  # down to what somebody sits on
_TOPS = ((150, 60, 52), (86, 104, 132), (190, 184, 170), (60, 92, 70), (170, 130, 60))
_TROUSERS = ((52, 60, 84), (92, 82, 70), (48, 48, 52), (110, 112, 120))
_STATURES_M = (1.75, 1.66, 1.83, 1.7, 1.78, 1.6, 1.75, 1.72, 1.8, 1.68)


@dataclass(frozen=True, slots=True)
class StanceSession:
    """rig: `pair` (wide), `stereo` (12 cm apart) or `ring` (four around); seat: on a chair that was there before."""

    name: str
    stance: str
    rig: str
    yaw_deg: float = 0.0
    seat: bool = False


SESSIONS = (
    StanceSession("sits", "sits", "pair", 10.0, seat=True),
    StanceSession("sits_low", "sits_low", "stereo", -15.0, seat=True),
    StanceSession("kneels", "kneels", "stereo", 20.0),
    StanceSession("sits_on_heels", "sits_on_heels", "ring"),
    StanceSession("squats", "squats", "stereo", 15.0),
    StanceSession("crouches", "crouches", "pair", -20.0),
    StanceSession("lies", "lies", "ring", 30.0),
    StanceSession("stands_with_the_back", "stands", "stereo", 180.0),
    StanceSession("sits_with_the_back", "sits", "pair", 170.0, seat=True),
    StanceSession("cross_legged", "cross_legged", "pair", 5.0),
)


def record(session: StanceSession, folder: Path) -> None:
    """The session as a capture with its truth, in this folder."""
    number = SESSIONS.index(session)
    scenario = _scenario(session, number)
    export_capture(
        scenario, folder, SECONDS, performed=performed(STANCES[session.stance], session.yaw_deg)
    )


def scenario_of(name: str, rig: str, number: int) -> Scenario:
    """A room without a chair before cameras of this rig; number: of the clothes and of the noise."""
    scene = load_scenario(
        asset_path("scenarios") / ("gym_mono.toml" if rig == "ring" else "living_room.toml")
    )
    body = BodySpec(stature_m=_STATURES_M[number % len(_STATURES_M)], whole=True)
    clothes = Clothes(
        shirt="plain", top_srgb=_TOPS[number % len(_TOPS)], trousers_srgb=_TROUSERS[number % len(_TROUSERS)],
        top_weave=Weave(pattern="stripes" if number % 3 == 1 else "plain"),
    )  # fmt: skip
    return msgspec.structs.replace(
        scene, name=name, seed=4000 + number, loop_s=SECONDS, person_appears_s=EMPTY_S, scribble_s=0.2,
        cameras=_cameras(scene.cameras[0], rig), body=body, clothes=clothes, others=(), absences=(),
        motion=MotionSpec(keyframes=[PoseKeyframe(t_s=0.0)]),
        lights=tuple(msgspec.structs.replace(one, events=()) for one in scene.lights),
    )  # fmt: skip


def _scenario(session: StanceSession, number: int) -> Scenario:
    scenario = scenario_of(session.name, session.rig, number)
    if not session.seat:
        return scenario
    height_m = hips_height_m(STANCES[session.stance], World(scenario).skeleton) - _FROM_HIPS_M
    chair = Thing(
        kind="box", base_m=(0.0, 0.0, 0.0), size_m=(0.40, height_m, 0.38), yaw_deg=session.yaw_deg,
        srgb=(120, 84, 54), pattern="planks",
    )  # fmt: skip
    room = msgspec.structs.replace(scenario.room, things=(*scenario.room.things, chair))
    return msgspec.structs.replace(scenario, room=room)


def _cameras(seen: CameraSpec, rig: str) -> list[CameraSpec]:
    places_m = {
        "pair": [(-1.45, 1.42, 2.35), (1.6, 1.3, 2.2)],
        "stereo": [(0.2, 1.35, 3.0)],
        "ring": [(1.9, 1.6, 2.3), (2.2, 1.7, -1.9), (-1.9, 1.6, -2.2), (-2.2, 1.7, 1.9)],
    }[rig]
    cameras = [
        msgspec.structs.replace(
            seen, name=f"cam{k}", position_m=place, look_at_m=(0.0, 0.8, 0.0), focal_px=None, centre_px=None,
            fov_deg=60.0, dropped=0.0, clock_offset_s=0.0,
        )
        for k, place in enumerate(places_m)
    ]  # fmt: skip
    return stereo_pair(cameras[0]) if rig == "stereo" else cameras
