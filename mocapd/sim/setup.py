"""Makes what a user's calibration of the simulated rig would give."""

import msgspec
import numpy as np

from mocapd.sim.person_spec import MotionSpec, PoseKeyframe
from mocapd.sim.renderer import CameraRenderer, Set, figure_of
from mocapd.sim.scenario import CameraSpec, Scenario
from mocapd.sim.scenery.furniture import backdrop
from mocapd.sim.scenery.lamps import studio_lamps
from mocapd.sim.scribbles import scribble
from mocapd.sim.setup_record import SimSetup
from mocapd.sim.world import World, rig_of
from mocapd.types import LabelledPicture

# How the user poses for the pictures of the shirt: pose, yaw [deg]
MODEL_POSES = (
    ("t_pose", 0.0), ("relaxed", 0.0), ("t_pose", 180.0), ("goalpost", 35.0), ("relaxed", 150.0),
)  # fmt: skip


def setup_of(scenario: Scenario, renderers: list[CameraRenderer]) -> SimSetup:
    """The setup of a scenario with these renderers; without pictures of the shirt if the person wears none."""
    shirt = scenario.clothes.shirt != "plain"
    return SimSetup(
        rig=rig_of(scenario),
        stature_m=scenario.body.stature_m,
        scribbles={r.camera.name: scribble_picture(scenario, r) for r in renderers}
        if shirt
        else {},
        model=model_pictures(scenario) if shirt else (),
    )


def scribble_picture(scenario: Scenario, renderer: CameraRenderer) -> LabelledPicture:
    """The picture of one camera at `scribble_s`, with strokes."""
    state = World(scenario).at(scenario.scribble_s)
    pixels = renderer.picture(
        (state.pose, state.pose), state.light_levels, noise_key=-1, jacket=state.jacket
    )
    patch, _ = renderer.labels(state.pose, state.jacket)
    return LabelledPicture(pixels, scribble(patch, np.random.default_rng([scenario.seed, 5])))


def model_pictures(scenario: Scenario) -> tuple[LabelledPicture, ...]:
    """The person before a grey backdrop in neutral light, with strokes."""
    camera = CameraSpec(
        name="studio", position_m=(0.0, 1.30, 3.1), look_at_m=(0.0, 1.12, 0.0), vignetting=0.0
    )
    out: list[LabelledPicture] = []
    renderer: CameraRenderer | None = None
    stage = Set(backdrop(), studio_lamps(), np.zeros(3))
    for i, (pose, yaw_deg) in enumerate(MODEL_POSES):
        motion = MotionSpec(
            keyframes=[PoseKeyframe(t_s=0.0, pose=pose, yaw_deg=yaw_deg)], sway_deg=0.0
        )
        world = World(msgspec.structs.replace(scenario, cameras=[camera], motion=motion, others=[]))
        if renderer is None:
            renderer = CameraRenderer(world, [figure_of(world)], stage, 0, samples=1)
        at_rest = world.at(0.0).pose
        pixels = renderer.picture((at_rest, at_rest), np.ones(2), noise_key=i)
        patch, _ = renderer.labels(at_rest)
        rng = np.random.default_rng([scenario.seed, 6, i])
        out.append(LabelledPicture(pixels, scribble(patch, rng)))
    return tuple(out)
