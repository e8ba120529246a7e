"""Pictures agree with the truth they were drawn from."""

import cv2
import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.body.surface import posed_vertices
from mocapd.body.surface_building import build_surface
from mocapd.geometry.camera_model import project
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.sim.renderer import camera_renderers
from mocapd.sim.scenario import Scenario
from mocapd.sim.setup import model_pictures, scribble_picture
from mocapd.sim.world import World, rig_of
from mocapd.types import Bytes
from tests.sim.small import LAMP_OFF_S, LAMP_ON_S, renderers, scenario

TIMES = (0.0, 0.7, 1.3, 1.7)


def test_truth_joints_lie_on_the_rendered_person() -> None:
    world = World(scenario())
    for renderer in renderers():
        for t in TIMES:
            state = world.at(t)
            _, mask = renderer.labels(state.pose)
            grown = cv2.dilate(mask, np.ones((3, 3), np.uint8))
            # the generic surface's feet end before the joint of the toes
            joints = np.delete(state.joints_m, [INDEX["leftToes"], INDEX["rightToes"]], axis=0)
            x, y = np.round(project(renderer.camera, joints)).astype(int).T
            assert (grown[y, x] == 255).all()


def test_the_person_is_where_the_picture_differs_from_the_empty_room() -> None:
    renderer = renderers()[0]
    world = World(scenario())
    state = world.at(0.3)
    with_her = renderer.picture((state.pose, state.pose), state.light_levels, 1)
    empty = renderer.picture(None, state.light_levels, 1)
    _, mask = renderer.labels(state.pose)
    patch, _ = renderer.labels(state.pose)
    inside = cv2.erode((patch > 0).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    difference = np.abs(with_her.astype(int) - empty).max(axis=2)
    assert np.mean(difference[inside] > 12) > 0.95
    outside = cv2.dilate(mask, np.ones((5, 5), np.uint8)) == 0
    # only her shadow and nothing else changes out there
    assert (with_her.astype(int) - empty)[outside].max() < 25


def test_labels_agree_with_the_projected_patches() -> None:
    world = World(scenario())
    surface = build_surface(world.shape)
    for renderer in renderers():
        for t in TIMES:
            state = world.at(t)
            patch, mask = renderer.labels(state.pose)
            assert not patch[mask == 0].any()
            vertices = posed_vertices(surface, world.skeleton, state.pose, state.joints_m)
            pixels = project(renderer.camera, vertices)
            seen = [p for p in range(1, 21) if (patch == p).sum() > 15]
            assert len(seen) >= 8
            for p in seen:
                corners = pixels[np.unique(surface.triangles[surface.area == p])]
                y, x = np.nonzero(patch == p)
                slack = 2.0  # folds and rounding stand out a little from the coarse surface
                assert x.min() > corners[:, 0].min() - slack
                assert x.max() < corners[:, 0].max() + slack
                assert y.min() > corners[:, 1].min() - slack
                assert y.max() < corners[:, 1].max() + slack


def _mean(picture: Bytes) -> float:
    return float(picture.mean())


def test_the_lamp_going_out_darkens_and_cools_the_picture_and_it_comes_back() -> None:
    renderer = renderers()[0]
    before, off, back = (
        renderer.frame(round((t + 0.2) * 30)) for t in (LAMP_OFF_S - 0.4, LAMP_OFF_S, LAMP_ON_S)
    )
    assert _mean(off) < 0.9 * _mean(before)
    assert abs(_mean(back) - _mean(before)) < 0.05 * _mean(before)

    def blueness(picture: Bytes) -> float:
        return float(picture[..., 0].mean() / picture[..., 2].mean())

    assert blueness(off) > 1.1 * blueness(before)


def test_frames_repeat_for_one_seed_and_differ_in_noise_for_another() -> None:
    def frame(s: Scenario) -> Bytes:
        return camera_renderers(World(s), samples=1)[0].frame(4)

    same, again, other = frame(scenario()), frame(scenario()), frame(scenario(seed=6))
    assert np.array_equal(same, again)
    assert not np.array_equal(same, other)


def test_noise_changes_from_frame_to_frame_by_the_amount_asked_for() -> None:
    renderer = renderers()[0]
    empty = [renderer.picture(None, np.ones(2), key).astype(float) for key in range(6)]
    assert not np.array_equal(empty[0], empty[1])
    spread = np.std(empty, axis=0).mean()
    assert 0.3 < spread < 6.0


def test_a_longer_shutter_smears_a_moving_arm() -> None:
    table = {
        "motion": {
            "keyframes": [{"t_s": 0.0, "pose": "relaxed"}, {"t_s": 1.0, "pose": "arms_up"}],
        }
    }
    blurred = []
    for shutter_s in (0.001, 0.033):
        s = scenario(**table)
        cameras = [{**_plain(camera), "shutter_s": shutter_s} for camera in s.cameras[:1]]
        renderer = camera_renderers(World(scenario(**table, cameras=cameras)), samples=1)[0]
        blurred.append(renderer.frame(15))
    sharpness = [cv2.Laplacian(b[10:70], cv2.CV_64F).var() for b in blurred]
    assert sharpness[1] < sharpness[0]


def _plain(camera: object) -> dict[str, object]:
    fields = {f: getattr(camera, f) for f in ("name", "position_m", "look_at_m", "size_px")}
    return dict(fields)


def test_the_room_is_seen_through_the_same_lens_as_truth() -> None:
    for renderer, camera in zip(renderers(), rig_of(scenario()).cameras, strict=True):
        points = renderer.background.points_m
        y, x = np.mgrid[: points.shape[0], : points.shape[1]]
        back = project(camera, points.astype(float)) - np.stack([x, y], axis=-1)
        # each point was cast through one of the samples inside its pixel
        assert np.abs(back).max() < 0.51


def test_strokes_lie_on_their_colours() -> None:
    patch, _ = renderers()[0].labels(World(scenario()).pose(0.0))
    strokes = scribble_picture(scenario(), renderers()[0]).labels
    colour = standard_shirt().colour_of_patch[patch]
    on = strokes > 0
    assert on.sum() > 50
    assert np.mean(strokes[on] == colour[on]) > 0.9


def test_model_pictures_show_all_ten_colours_as_the_standard_has_them() -> None:
    pictures = model_pictures(scenario())
    assert len(pictures) == 5
    seen: dict[int, list[np.ndarray]] = {}
    for picture in pictures:
        for c in np.unique(picture.labels[picture.labels > 0]):
            seen.setdefault(int(c), []).append(picture.pixels[picture.labels == c])
    assert sorted(seen) == list(range(1, 11))
    standard = standard_shirt().srgb.astype(float)
    hue = standard / standard.sum(axis=1, keepdims=True)
    right = []
    for c, pixels in seen.items():
        rgb = np.concatenate(pixels)[:, ::-1].astype(float)
        chroma = rgb / rgb.sum(axis=1, keepdims=True)
        nearest = np.argmin(np.linalg.norm(chroma[:, None] - hue, axis=2), axis=1) + 1
        right.append(np.mean(nearest == c))
    assert min(right) > 0.7
