"""The whole colour chain on recordings: model from model/, W from scribble/, scored by labels/."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.assets import asset_path
from mocapd.shirt.colour.colour_model import ColourModel, fit_colour_model
from mocapd.shirt.colour.colour_tables import colour_table
from mocapd.shirt.colour.lut_kernels import classify_by_table
from mocapd.shirt.colour.strokes import read_labelled, stroke_means
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.types import Bytes
from tests.shirt.example_colours import NAMES

pytestmark = pytest.mark.kernels

FRAMES = (60, 120, 180)


def model_of(capture: Path) -> ColourModel:
    folder = capture / "model"
    labelled = [read_labelled(folder / f"{i}.png") for i in range(5)]
    return fit_colour_model([a.pixels for a in labelled], [a.labels for a in labelled], NAMES)


def frames_with_truth(capture: Path) -> list[tuple[Bytes, Bytes]]:
    """Frames of cam0 (h,w,3) and the true colour id of each pixel (h,w)."""
    patches = json.loads(asset_path("shirt_standard_v1.json").read_text())["patches"]
    colour_of_patch = np.array([0] + [patch["colour"] for patch in patches], dtype=np.uint8)
    video = cv2.VideoCapture(str(capture / "cam0.mp4"))
    pairs = []
    for index in range(max(FRAMES) + 1):
        frame = np.asarray(video.read()[1], dtype=np.uint8)
        if index in FRAMES:
            labels = cv2.imread(str(capture / "labels" / f"cam0_{index:06d}.png"), -1)
            pairs.append((frame, colour_of_patch[labels]))
    return pairs


@pytest.mark.parametrize("name", ["pair_office_traffic", "pair_clutter_jacks"])
def test_the_shirt_is_read_under_the_light_it_was_scribbled_in(
    dev_captures: Callable[[str], Path], name: str
) -> None:
    capture = dev_captures(name)
    model = model_of(capture)
    scribble = read_labelled(capture / "scribble" / "cam0.png")
    means, counts = stroke_means(scribble.pixels, scribble.labels)
    everywhere = np.ones((1, 1), dtype=np.uint8)
    correct = {}
    for variant, T in ((model, 3.0), (model.tolerating(), 2.0)):
        precision = shade_precision(model) if variant is not model else None
        W = solve_white_balance(means, model.mean, counts, precision=precision)
        table = colour_table(variant, W, T)
        right = wrong = shirt = 0
        for frame, truth in frames_with_truth(capture):
            ids = np.zeros(truth.shape, dtype=np.uint8)
            classify_by_table(frame, everywhere, 31, table, 0, 0, 1, ids)
            shirt += (truth > 0).sum()
            right += ((ids == truth) & (truth > 0)).sum()
            wrong += ((ids != truth) & (ids > 0) & (truth > 0)).sum()
        correct[variant.shading_sigma] = right / shirt
        assert wrong < 0.05 * right
    assert correct[0.0] > 0.4  # the paper's T = 3
    assert correct[0.25] > 0.75  # with tolerance for shade
