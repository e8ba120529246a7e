"""Scenes that mislead a tracker without the shirt, rendered once each: faces that are nobody's, and somebody else."""

from dataclasses import dataclass
from typing import Any

from mocapd.calibration.calibration_record import Calibration
from mocapd.sim.renderer import camera_renderers
from mocapd.sim.setup import setup_of
from mocapd.sim.world import World
from mocapd.types import Floats, Frame, FrameSet
from tests.sim import small
from tests.sim.kept_film import kept
from tests.sim.simulated_calibration import calibration_of_setup

START_NS = 50_000_000_000_000
PERIOD_NS = 33_333_333
N_EMPTY = 22  # frames before the person comes, where one does

PORTRAIT = {"kind": "portrait", "base_m": [-0.7, 1.0, -1.6], "size_m": [0.6, 0.8, 0.02]}
_WAVING = [
    {"t_s": 0.0, "pose": "relaxed", "at_m": [0.0, 0.0]},
    {"t_s": 0.5, "pose": "arms_up", "at_m": [0.3, 0.0]},
    {"t_s": 1.0, "pose": "relaxed", "at_m": [-0.3, 0.0]},
    {"t_s": 1.5, "pose": "star", "at_m": [0.2, 0.0]},
]
TELEVISION = {
    "screen": {"base_m": [0.9, 0.6, -1.6], "height_m": 0.9},
    "body": {"whole": True, "stature_m": 1.8},
    "clothes": {"shirt": "plain", "top_srgb": [190, 60, 50]},
    "motion": {"keyframes": _WAVING},
}
PASSER_BY = {
    "body": {"whole": True, "stature_m": 1.8},
    "clothes": {"shirt": "plain", "top_srgb": [60, 120, 70]},
    "motion": {
        "keyframes": [
            {"t_s": 0.0, "pose": "relaxed", "at_m": [-2.4, -1.3], "yaw_deg": 90.0},
            {"t_s": 0.6, "at_m": [-2.4, -1.3], "yaw_deg": 90.0},
            {"t_s": 2.8, "at_m": [1.8, -1.3], "yaw_deg": 90.0},
        ]
    },
}
BESIDE = {  # as near as the person
    "body": {"whole": True, "stature_m": 1.7},
    "clothes": {"shirt": "plain", "top_srgb": [160, 150, 60]},
    "motion": {
        "keyframes": [
            {"t_s": 0.0, "pose": "relaxed", "at_m": [3.0, 0.0]},
            {"t_s": 1.1, "pose": "relaxed", "at_m": [3.0, 0.0]},
            {"t_s": 1.8, "pose": "wave_left", "at_m": [0.9, 0.0]},
        ]
    },
}


@dataclass(frozen=True, slots=True, eq=False)
class HardFilm:
    """frames, and where the person's joints (J,3) are in each, None while nobody is there."""

    known: Calibration
    frames: list[FrameSet]
    joints_m: list[Floats | None]


@kept
def hard_film(scene: str) -> HardFilm:
    """Two cameras of 320x240 whose views cross, in steady light; one of SCENES until all has moved that moves."""
    table: dict[str, Any] = small.table()
    for camera, x in zip(table["cameras"], (-0.06, 0.06), strict=True):
        camera |= {"size_px": [320, 240], "dropped": 0.0, "clock_offset_s": 0.0}
        if scene == CLOSE_PAIR:
            camera |= {"position_m": [x, 1.4, 2.8], "look_at_m": [x, 0.95, 0.0]}
    for light in table["lights"]:
        light["events"] = []
    table |= {"clothes": {"shirt": "plain"}, "body": {"whole": True}, "loop_s": 4.0}
    keys = [
        {"t_s": 0.0, "pose": "relaxed"},
        {"t_s": 1.4, "pose": "relaxed"},
        {"t_s": 2.4, "pose": "arms_up", "at_m": [-0.1, 0.1], "yaw_deg": 10.0},
    ]
    table |= {"motion": {"keyframes": keys}, "person_appears_s": N_EMPTY / 30.0}
    table |= SCENES[scene]
    table["room"] = {"things": [*small.TABLE["room"]["things"], PORTRAIT]}
    scenario = small.scenario(**table)
    world = World(scenario)
    renderers = camera_renderers(world)
    frames, joints_m = [], []
    for k in range(_LONGER.get(scene, _FRAMES)):
        t_ns = START_NS + k * PERIOD_NS
        shown = {r.camera.name: Frame(r.camera.name, k, t_ns, r.frame(k)) for r in renderers}
        frames.append(FrameSet(t_ns, shown, 0))
        state = world.at(renderers[0].exposure_s(k))
        joints_m.append(state.joints_m if state.person_present else None)
    return HardFilm(calibration_of_setup(setup_of(scenario, renderers)), frames, joints_m)


_FRAMES, _LONGER = 75, {"passer_by": 90, "turns_away": 90}
CLOSE_PAIR = "close_pair"  # 12 cm apart, straight ahead
SCENES: dict[str, dict[str, Any]] = {
    "television": {"person_appears_s": 4.0, "others": [TELEVISION]},
    "before_a_television": {"others": [TELEVISION]},
    "passer_by": {"others": [PASSER_BY]},
    CLOSE_PAIR: {},
    "two_people": {"others": [BESIDE]},
    "turns_away": {
        "motion": {
            "keyframes": [
                {"t_s": 0.0, "pose": "relaxed", "at_m": [0.0, 0.0], "yaw_deg": 0.0},
                {"t_s": 1.2, "yaw_deg": 0.0},
                {"t_s": 2.2, "yaw_deg": 180.0},
                {"t_s": 3.4, "yaw_deg": 180.0},
            ]
        }
    },
}
