"""Strokes are proposed on simulated pictures without a word about their light."""

import numpy as np
import pytest

from lab.studies.colour_proposals import score_by_labels, score_by_strokes, table
from mocapd.calibrate.colours.colour_solution import personal_colour_model
from mocapd.calibrate.colours.light_hypotheses import (
    LEVELS,
    MIREDS,
    TINTS_UV,
    black_body_rgb,
    light_hypotheses,
)
from mocapd.calibrate.colours.stroke_proposal import (
    Proposal,
    interiors,
    of_one_dye,
    propose_strokes,
)
from mocapd.errors import InputError
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.setup import setup_of
from mocapd.sim.setup_record import SimSetup
from mocapd.sim.world import World
from mocapd.types import Bytes, Camera, LabelledPicture, Rig
from tests.calibrate.swatches import MODEL, swatches
from tests.sim import small

pytestmark = pytest.mark.kernels


class Scene:
    """Two cameras and a person with the arms out, in a warm and a cool lamp."""

    def __init__(self) -> None:
        scene = small.table()
        for camera in scene["cameras"]:
            camera |= {"size_px": [320, 240]}
        scenario = small.scenario(**scene)
        world = World(scenario)
        self.renderers: list[CameraRenderer] = camera_renderers(world)
        self.setup: SimSetup = setup_of(scenario, self.renderers)
        state = world.at(scenario.scribble_s)
        self.patch = {r.camera.name: r.labels(state.pose)[0] for r in self.renderers}
        self.pixels: dict[str, Bytes] = {n: s.pixels for n, s in self.setup.scribbles.items()}
        self.cameras: dict[str, Camera] = {c.name: c for c in self.setup.rig.cameras}
        self.model: ColourModel = colour_model(self.setup.model)
        self.W = white_balances(self.setup.scribbles, self.model)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return Scene()


@pytest.fixture(scope="module")
def database(smaller_database: PoseDatabase) -> PoseDatabase:
    return smaller_database


def propose_alone(pixels: Bytes, camera: Camera, scene: Scene, database: PoseDatabase) -> Proposal:
    return propose_strokes({camera.name: pixels}, Rig((camera,)), scene.model, database)[
        camera.name
    ]


@pytest.fixture(scope="module")
def alone(scene: Scene, database: PoseDatabase) -> Proposal:
    return propose_alone(scene.pixels["left"], scene.cameras["left"], scene, database)


def test_strokes_are_right_and_give_the_users_white_balance(scene: Scene, alone: Proposal) -> None:
    score = score_by_labels(alone.strokes, scene.patch["left"], alone.W, scene.W["left"])
    assert score.right > 0.9
    assert score.patches > 0.9
    assert score.W_error < 0.3
    assert ((alone.strokes == 0) | (alone.strokes == alone.shirt)).all()


def test_the_light_may_be_any(scene: Scene, database: PoseDatabase) -> None:
    # a lens cap of orange glass
    tinted = np.clip(scene.pixels["left"] * np.array([0.6, 0.85, 1.0]), 0, 255).astype(np.uint8)
    found = propose_alone(tinted, scene.cameras["left"], scene, database)
    score = score_by_labels(found.strokes, scene.patch["left"], found.W, scene.W["left"])
    assert score.right > 0.9
    assert score.patches > 0.8
    assert found.W[2, 2] / found.W[0, 0] > 1.3 * scene.W["left"][2, 2] / scene.W["left"][0, 0]


def test_without_a_lens_a_usual_one_is_assumed(scene: Scene, database: PoseDatabase) -> None:
    usual = nominal_rig("camera", scene.cameras["left"].size_px).cameras[0]
    found = propose_alone(scene.pixels["left"], usual, scene, database)
    score = score_by_labels(found.strokes, scene.patch["left"], found.W, scene.W["left"])
    assert score.right > 0.9


def test_cameras_of_a_rig_are_read_together(scene: Scene, database: PoseDatabase) -> None:
    found = propose_strokes(
        scene.pixels, scene.setup.rig, scene.model, database, scene.setup.stature_m
    )
    assert set(found) == {"left", "right"}
    for name, one in found.items():
        score = score_by_strokes(
            one.strokes, scene.setup.scribbles[name].labels, one.W, scene.W[name]
        )
        assert score.right > 0.9
        assert score.W_error < 0.3


def test_an_empty_room_is_refused_with_advice(scene: Scene, database: PoseDatabase) -> None:
    empty = scene.renderers[0].picture(None, np.ones(2), noise_key=7)
    with pytest.raises(InputError, match="no shirt was found under any light"):
        propose_alone(empty, scene.cameras["left"], scene, database)


def test_a_picture_of_another_mode_is_refused(scene: Scene, database: PoseDatabase) -> None:
    with pytest.raises(InputError, match="the lens is known for 320x240"):
        propose_alone(scene.pixels["left"][:200].copy(), scene.cameras["left"], scene, database)


def test_interiors_stay_off_borders_and_leave_out_what_the_picture_denies() -> None:
    rendered = np.zeros((40, 60), np.uint8)
    rendered[5:35, 5:25], rendered[5:35, 25:45] = 1, 2
    classified = rendered.copy()
    classified[:, 31:45] = 7
    strokes = interiors(rendered, classified)
    assert (strokes[6:34, 6:24] == 1).all()
    assert not strokes[:, 24:].any()


def test_lights_undo_what_they_do() -> None:
    candle, sky = black_body_rgb(1e6 / 2400), black_body_rgb(1e6 / 12000)
    assert candle[0] > 1.0 > candle[2]
    assert sky[0] < 1.0 < sky[2]
    np.testing.assert_allclose(black_body_rgb(1e6 / 6504), 1.0, atol=1e-9)
    green = black_body_rgb(1e6 / 4000, 0.01)
    plain, pink = black_body_rgb(1e6 / 4000), black_body_rgb(1e6 / 4000, -0.01)
    assert green[0] + green[2] < plain[0] + plain[2] < pink[0] + pink[2]
    pixels, _ = swatches(np.array([1.1, 1.0, 0.5]))
    grey = light_hypotheses(pixels)[len(MIREDS) * len(TINTS_UV) * len(LEVELS)]  # after the locus
    balanced = pixels.reshape(-1, 3).mean(axis=0)[::-1] @ grey.T
    np.testing.assert_allclose(balanced, balanced.mean(), rtol=1e-6)


def test_a_personal_model_keeps_the_dye_and_drops_the_light() -> None:
    light = np.array([1.0, 0.9, 0.7])
    pixels, strokes = swatches(light)
    again = personal_colour_model({"cam0": LabelledPicture(pixels, strokes)}, MODEL)
    np.testing.assert_allclose(again.mean, MODEL.mean, atol=0.08)
    pale = pixels.copy()
    pale[strokes == 5] = (0.7 * pale[strokes == 5] + 40).astype(np.uint8)
    other = personal_colour_model({"cam0": LabelledPicture(pale, strokes)}, MODEL)
    moved = np.linalg.norm(other.mean - again.mean, axis=1)
    assert moved.argmax() == 4


def test_the_table_names_every_picture() -> None:
    strokes = np.zeros((20, 20), np.uint8)
    strokes[2:8, 2:18] = 1
    patch = np.zeros((20, 20), np.uint8)
    patch[:10], patch[10:] = 1, 2
    score = score_by_labels(strokes, patch, np.eye(3), 1.1 * np.eye(3))
    assert score.right == 1.0
    assert score.patches == pytest.approx(0.5)
    assert score.W_error == pytest.approx(0.1 * np.sqrt(3))
    assert "cam7" in table({"cam7": score})


def test_a_wall_of_nearly_the_same_colour_is_left_out_and_shade_is_not() -> None:
    rng = np.random.default_rng(3)
    lit = np.array([158.0, 153.0, 242.0])  # a pink sleeve, BGR
    picture = np.tile(lit, (40, 60, 1))
    picture[:, 30:] *= np.linspace(1.0, 0.5, 30)[None, :, None]  # its far side is in shade
    picture[:10] = [94.0, 110.0, 131.0]  # a wall above it
    pixels = np.clip(picture + rng.normal(0.0, 3.0, picture.shape), 0, 255).astype(np.uint8)
    strokes = np.zeros((40, 60), np.uint8)
    strokes[4:30, 5:55] = 10
    kept = of_one_dye(strokes, pixels)
    assert (kept[4:10, 5:55] > 0).mean() < 0.01
    assert (kept[10:30, 5:55] == 10).mean() > 0.98
