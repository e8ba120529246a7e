"""Scenes for what the paper's tracker without a shirt got wrong, and one of everything that goes wrong around it.

Hecht et al. (2009) name them: a person seen from the side, a leg that hides the other, a moving limb that drags a
still one along, folded arms, and a turn right round; somebody who walks by close to a lens is ours. Each scene begins with
somebody who hangs the arms and ends in the open, so that it can be told how long a tracker needs until it is right again.
"""

from dataclasses import dataclass

import msgspec

from lab.simulated.session_plan import EMPTY_S, PlannedSession
from lab.simulated.variation import stereo_pair
from mocapd.sim.person_spec import (
    BodySpec,
    Bystander,
    Clothes,
    ClothesEvent,
    Jacket,
    MotionSpec,
    PoseKeyframe,
    Weave,
)
from mocapd.sim.scenario import CameraSpec, Light, LightEvent, Scenario
from mocapd.sim.scenario_values import Span

_LOOP_S = 8.0
_BODY = BodySpec(stature_m=1.74, whole=True)
_CLOTHES = Clothes(
    shirt="plain",
    top_srgb=(86, 104, 132),
    top_weave=Weave(pattern="stripes", srgb=(206, 204, 196), period_m=0.08),
    trousers_srgb=(92, 82, 70),
    shoes_srgb=(186, 60, 52),
)
_OUT_LEFT = ((0.9, -0.35, 0.3), (0.7, -0.2, 0.7))
_ACROSS = ((-0.05, -0.75, 0.65), (-0.85, 0.0, 0.55))
_HELD = ((-0.15, -0.9, 0.15), (0.05, -0.05, 1.0))  # the right forearm, forwards


def _key(t_s: float, pose: str = "relaxed", **more: object) -> PoseKeyframe:
    return msgspec.structs.replace(PoseKeyframe(t_s=t_s, pose=pose), **more)


# half a metre before the lenses of the wide pair, a metre before those of the other
_WALKS_BY = Bystander(
    body=BodySpec(stature_m=1.8, whole=True),
    clothes=Clothes(shirt="plain", top_srgb=(70, 110, 60), trousers_srgb=(40, 44, 60)),
    motion=MotionSpec(
        keyframes=[
            _key(0.0, at_m=(-3.4, 2.2), yaw_deg=90.0),
            _key(1.6, at_m=(-3.4, 2.2), yaw_deg=90.0),
            _key(4.6, at_m=(3.4, 2.2), yaw_deg=90.0),
            _key(5.6, at_m=(3.4, 7.0), yaw_deg=0.0),  # and back, behind the cameras
            _key(7.0, at_m=(-3.4, 7.0), yaw_deg=0.0),
        ]
    ),
)


@dataclass(frozen=True, slots=True)
class FailureScene:
    """keys: between the first second, in which the person hangs the arms, and the last half second. clear_s: from
    then on nothing hides the person any more [s]. others: who comes along."""

    name: str
    clear_s: float
    keys: tuple[PoseKeyframe, ...]
    others: tuple[Bystander, ...] = ()


FAILURE_SCENES = (
    FailureScene("from_the_side", 5.0, (
        _key(2.4, yaw_deg=90.0), _key(3.0, "arms_forward"), _key(3.6), _key(4.3, yaw_deg=90.0),
        _key(5.0, yaw_deg=0.0), _key(6.0, "goalpost"), _key(6.8, "wave_left"),
    )),
    FailureScene("legs_that_cross", 5.2, (
        _key(2.0, yaw_deg=90.0, at_m=(-0.65, 0.0)), _key(4.0, yaw_deg=90.0, at_m=(0.55, 0.0)),
        _key(4.5, yaw_deg=20.0, at_m=(0.4, 0.0), left_foot_m=(-0.32, 0.02, 0.14)),
        _key(4.8, left_foot_m=(-0.32, 0.02, 0.14)), _key(5.2, yaw_deg=0.0, at_m=(0.2, 0.0)),
        _key(6.0, left_foot_m=(0.3, 0.2, 0.05)), _key(6.6, at_m=(0.0, 0.0)),
    )),
    FailureScene("a_limb_that_passes_another", 5.2, (
        _key(1.7, right_arm=_HELD),
        _key(2.2, left_arm=_OUT_LEFT, right_arm=_HELD), _key(2.8, left_arm=_ACROSS, right_arm=_HELD),
        _key(3.4, left_arm=_OUT_LEFT, right_arm=_HELD),
        _key(3.9, left_arm=_ACROSS, right_arm=_HELD, left_foot_m=(-0.30, 0.16, 0.28)),
        _key(4.5, left_arm=_OUT_LEFT, right_arm=_HELD, left_foot_m=(0.25, 0.12, 0.0)),
        _key(5.2), _key(6.4, "arms_forward"),
    )),
    FailureScene("folded_arms", 5.0, (
        _key(2.1, "crossed"), _key(4.4, "crossed", yaw_deg=15.0), _key(5.0, yaw_deg=0.0),
        _key(5.8, "goalpost"), _key(6.6, "archer"),
    )),
    FailureScene("right_round", 5.0, (
        _key(2.2, yaw_deg=90.0), _key(3.2, yaw_deg=180.0), _key(4.1, yaw_deg=270.0),
        _key(5.0, yaw_deg=360.0), _key(6.0, "arms_up"), _key(6.8, "hands_on_hips"),
    )),
    FailureScene("close_to_the_lens", 4.6, (
        _key(2.4, "goalpost"), _key(3.2), _key(4.0, "arms_forward"), _key(5.0), _key(6.0, "wave_left"),
        _key(6.8, "star"),
    ), (_WALKS_BY,)),
)  # fmt: skip


def failure_sessions(scene: Scenario) -> list[PlannedSession]:
    """Each failure in this room, before a pair 12 cm apart and a wide one; then the interruptions."""
    rigs = _rigs(scene)
    sessions = []
    for number, one in enumerate(FAILURE_SCENES):
        last = one.keys[-1]
        turned = 360.0 if any((key.yaw_deg or 0.0) >= 360.0 for key in one.keys) else 0.0
        keys = [
            _key(0.0, at_m=(0.0, 0.0), yaw_deg=0.0),
            _key(1.4),
            *one.keys,
            _key(max(7.4, last.t_s + 0.5), at_m=(0.0, 0.0), yaw_deg=turned),
        ]
        for rig, cameras in rigs.items():
            name = f"failure_{rig}_{one.name}"
            scenario = msgspec.structs.replace(
                scene, name=name, seed=3000 + number, loop_s=_LOOP_S, person_appears_s=EMPTY_S, cameras=cameras,
                body=_BODY, clothes=_CLOTHES, motion=MotionSpec(keyframes=keys), lights=_steady(scene),
                others=one.others,
            )  # fmt: skip
            sessions.append(PlannedSession(name, scenario, clear_s=one.clear_s))
    return [*sessions, interruptions(scene, rigs["pair"])]


def interruptions(scene: Scenario, cameras: list[CameraSpec]) -> PlannedSession:
    """The shirt is covered by a jacket and free again, the lamps go out, a camera is lost and comes back, and the
    person leaves the room and returns."""
    keys = [
        _key(0.0, "t_pose", at_m=(0.0, 0.0), yaw_deg=0.0), _key(1.4, "t_pose"), _key(2.2), _key(3.0, "goalpost"),
        _key(5.0), _key(6.0, "arms_forward"), _key(7.0), _key(8.0, "guard"), _key(9.5), _key(10.2, "wave_left"),
        _key(11.2), _key(12.0, "reach_right"), _key(13.0, yaw_deg=0.0, at_m=(0.0, 0.0)), _key(13.6, yaw_deg=60.0),
        _key(16.4, yaw_deg=63.0, at_m=(2.4, 1.2)), _key(17.2, yaw_deg=153.0), _key(18.0, yaw_deg=243.0),
        _key(20.8, yaw_deg=250.0, at_m=(0.1, 0.0)), _key(21.6, yaw_deg=360.0, at_m=(0.0, 0.0)), _key(22.4, "star"),
        _key(23.0, "relaxed"), _key(23.6, "t_pose", at_m=(0.0, 0.0), yaw_deg=360.0),
    ]  # fmt: skip
    dark = (
        LightEvent(t_s=8.6, level=0.06, over_s=0.05),
        LightEvent(t_s=10.0, level=1.0, over_s=0.05),
    )
    lost = msgspec.structs.replace(cameras[1], outages=(Span(from_s=11.0, to_s=12.8),))
    clothes = msgspec.structs.replace(
        scene.clothes,
        jacket=Jacket(srgb=(52, 58, 66)),
        events=(
            ClothesEvent(t_s=3.2, jacket=1.0, over_s=1.6),
            ClothesEvent(t_s=6.2, jacket=0.0, over_s=1.4),
        ),
    )
    scenario = msgspec.structs.replace(
        scene, name="interruptions", seed=3100, loop_s=24.0, person_appears_s=EMPTY_S, scribble_s=1.0,
        cameras=[cameras[0], lost], body=_BODY, clothes=clothes, motion=MotionSpec(keyframes=keys),
        lights=tuple(msgspec.structs.replace(light, events=dark) for light in scene.lights),
        absences=(Span(from_s=15.6, to_s=18.4),),
    )  # fmt: skip
    return PlannedSession("interruptions", scenario)


def standing_sessions(scene: Scenario) -> list[tuple[PlannedSession, float]]:
    """Somebody who stands still for ten seconds, in the shirt and in plain clothes, before both rigs; and since when [s]."""
    still_s = 3.0  # arms hang since 2.2 s; whoever is found then settles
    keys = [
        _key(0.0, "t_pose", at_m=(0.0, 0.0), yaw_deg=0.0), _key(1.4, "t_pose"), _key(2.2),
        _key(still_s + 10.4, at_m=(0.0, 0.0), yaw_deg=0.0),
    ]  # fmt: skip
    sessions = []
    for number, (rig, cameras) in enumerate(_rigs(scene).items()):
        for worn, clothes in (("shirt", scene.clothes), ("plain", _CLOTHES)):
            scenario = msgspec.structs.replace(
                scene, name=f"rest_{rig}_{worn}", seed=3200 + number, loop_s=still_s + 10.9, person_appears_s=EMPTY_S,
                scribble_s=1.0, cameras=cameras, body=_BODY, clothes=clothes, motion=MotionSpec(keyframes=keys),
                lights=_steady(scene),
            )  # fmt: skip
            sessions.append((PlannedSession(scenario.name, scenario), still_s))
    return sessions


def _rigs(scene: Scenario) -> dict[str, list[CameraSpec]]:
    """A pair 12 cm apart and a wide one, which see the whole body."""
    seen = msgspec.structs.replace(
        scene.cameras[0],
        focal_px=None,
        centre_px=None,
        fov_deg=58.0,
        dropped=0.0,
        clock_offset_s=0.0,
    )
    return {
        "stereo": stereo_pair(_placed(seen, "cam0", (0.2, 1.35, 3.1))),
        "pair": [_placed(seen, "cam0", (-1.7, 1.4, 2.6)), _placed(seen, "cam1", (1.8, 1.3, 2.5))],
    }


def _placed(camera: CameraSpec, name: str, at_m: tuple[float, float, float]) -> CameraSpec:
    return msgspec.structs.replace(camera, name=name, position_m=at_m, look_at_m=(0.0, 0.95, 0.0))


def _steady(scene: Scenario) -> tuple[Light, ...]:
    return tuple(msgspec.structs.replace(light, events=()) for light in scene.lights)
