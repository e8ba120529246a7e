"""Counting right and wrong colours; the classifiers over thresholds; a recorded pose drawn again."""

import numpy as np
import pytest

from lab.compared.retraced import proportions, states
from lab.compared.roc import (
    MIXED,
    Counts,
    colour_truth,
    correct_at,
    count,
    no_roc,
    sweep_alone,
    sweep_assisted,
)
from mocapd.body.model import build_model
from mocapd.body.skeleton import N_JOINTS
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import (
    MotionState,
    initial_information,
    predict_pose,
    step_between,
)
from mocapd.fit.solver import Fitter
from mocapd.geometry.rotations import IDENTITY_XYZW, exp
from mocapd.published.wang2011.distance_maps import distance_maps
from mocapd.session.offline import RecordedTrack
from mocapd.shirt.colour.colour_model import ColourModel, fold
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes
from tests.geometry.rigs import ring

pytestmark = pytest.mark.kernels


def test_blocks_of_one_colour_have_it_and_others_are_mixed() -> None:
    colour_of = standard_shirt().colour_of_patch
    label = np.zeros((8, 8), np.uint8)
    label[2:4, 2:4] = 5
    label[4:6, 2:3] = 7  # half a block
    truth = colour_truth(label, (2, 2, 7, 8), 2)  # a column is left over
    assert truth.shape == (3, 2)
    assert truth[0, 0] == colour_of[5]
    assert truth[1, 0] == MIXED
    assert truth[2, 1] == 0


def test_two_patches_of_one_colour_are_not_mixed() -> None:
    colour_of = standard_shirt().colour_of_patch
    first, second = np.flatnonzero(colour_of == 1)[:2]
    label = np.array([[first, second], [second, first]], np.uint8)
    assert colour_truth(label, (0, 0, 2, 2), 2)[0, 0] == 1


def test_counts_of_a_small_picture() -> None:
    truth = np.array([[0, 0, 3, 3], [4, 4, MIXED, 0]], np.uint8)
    ids = np.array([[0, 2, 3, 0], [4, 3, 4, 0]], np.uint8)
    counts = count(truth, [ids, np.zeros_like(ids)])
    assert counts.right.tolist() == [2.0, 0.0]
    assert counts.wrong.tolist() == [
        2.0,
        0.0,
    ]  # the 2 on nothing, the 3 on a 4; the mixed one is not counted
    assert (counts.shirt, counts.looked_at) == (4.0, 7.0)
    assert counts.correct.tolist() == [0.5, 0.0]
    both = counts + counts
    assert both.false.tolist() == counts.false.tolist()
    assert both.looked_at == 14.0


def test_correct_between_two_thresholds_is_interpolated() -> None:
    counts = Counts(np.array([10.0, 30.0]), np.array([0.0, 10.0]), 40.0, 100.0)
    assert correct_at(counts, 0.05) == pytest.approx(0.5)
    assert np.isnan(correct_at(counts, 0.2))


def confusing_picture(rng: np.random.Generator) -> tuple[Bytes, Bytes, ColourModel]:
    """A shirt of two like colours, side by side, before a wall with flecks of both."""
    mean = np.tile([0.9, 0.9, 0.9], (10, 1))
    mean[0], mean[1] = [0.6, 0.2, 0.2], [0.5, 0.3, 0.2]
    model = ColourModel(tuple("abcdefghij"), mean, np.tile(np.eye(3) * 0.05**2, (10, 1, 1)), "test")
    truth = np.zeros((40, 60), np.uint8)
    truth[10:30, 10:20], truth[10:30, 20:30] = 1, 2
    shown = truth.copy()
    flecks = (truth == 0) & (rng.random(truth.shape) < 0.3)
    shown[flecks] = rng.integers(1, 3, flecks.sum())
    rgb = np.where(shown[..., None] > 0, mean[np.maximum(shown, 1) - 1], [0.1, 0.1, 0.1])
    noisy = rgb + rng.normal(0.0, 0.05, rgb.shape)
    picture = np.clip(255 * noisy[..., ::-1], 0, 255).astype(np.uint8)
    return np.ascontiguousarray(picture), truth, model


def test_the_prior_classifies_more_at_fewer_false_positives() -> None:
    picture, truth, model = confusing_picture(np.random.default_rng(7))
    roi, whitening = (0, 0, 60, 40), fold(model, np.eye(3))
    alone = sweep_alone(truth, picture, roi, whitening)
    # the pose is right to a pixel or two
    rendered = np.roll(truth, (1, 2), axis=(0, 1))
    distance_px, _ = distance_maps(rendered, 100.0)
    assisted = sweep_assisted(truth, picture, roi, whitening, distance_px, 6.0 / 20.0)
    for counts in (alone, assisted):
        assert counts.shirt == 400.0
        given = counts.right + counts.wrong
        assert (np.diff(given) >= 0).all()  # a wider threshold never takes away
        assert given[-1] > given[0]
    for rate in (0.01, 0.02, 0.05):
        assert correct_at(assisted, rate) > correct_at(alone, rate) + 0.1


def test_without_weight_the_prior_changes_nothing() -> None:
    picture, truth, model = confusing_picture(np.random.default_rng(8))
    roi, whitening = (0, 0, 60, 40), fold(model, np.eye(3))
    far = np.full((10, *truth.shape), 50.0, np.float32)
    assisted = sweep_assisted(truth, picture, roi, whitening, far, 0.0)
    alone = sweep_alone(truth, picture, roi, whitening)
    rates = alone.false[(alone.false > 0) & (alone.false < alone.false.max())][3:-3]
    for rate in rates:
        assert correct_at(assisted, rate) == pytest.approx(correct_at(alone, rate), abs=0.03)


def test_nothing_counted_adds_nothing() -> None:
    total = no_roc() + no_roc()
    assert total.alone.shirt == 0.0
    assert np.isfinite(total.assisted.correct).all()


@pytest.fixture(scope="module")
def fitter() -> Fitter:
    body = build_model(1.7)
    return Fitter(body, shirt_labels(body), ring(2), [2, 2], FitParams())


def random_state(fitter: Fitter, rng: np.random.Generator) -> MotionState:
    group = fitter.model.group_of_joint
    local = exp(rng.normal(0.0, 0.3, (N_JOINTS, 3)))[fitter.model.joint_of_group[group]]
    local[group < 0] = IDENTITY_XYZW
    factors = np.ones(fitter.model.n_shape)
    factors[:4] += rng.normal(0.0, 0.05, 4)  # the lengths: all that joints can tell
    root = np.array([0.1, 0.95, -0.2])
    return MotionState(
        root, local, np.zeros(fitter.model.n_pose), factors, initial_information(fitter.model.space)
    )


def test_a_recorded_pose_becomes_the_state_it_was(fitter: Fitter) -> None:
    rng = np.random.default_rng(4)
    before, after = random_state(fitter, rng), random_state(fitter, rng)
    drawn = [fitter.joints(state) for state in (before, after)]
    joints, turned = (np.array(part) for part in zip(*drawn, strict=True))
    assert proportions(fitter.model, joints[0], turned[0]) == pytest.approx(before.factors)
    names = ("",) * N_JOINTS
    track = RecordedTrack(
        np.array([1.0, 1.1]), names, joints, turned, np.ones((2, N_JOINTS)), np.array(["", ""])
    )
    first, second = states(fitter, track)
    assert not first.velocity.any()
    for state, truth in ((first, before), (second, after)):
        assert fitter.joints(state)[0] == pytest.approx(fitter.joints(truth)[0], abs=1e-9)
    # back at this velocity for the time between them
    root, local = predict_pose(fitter.model, second, -0.1)
    assert root == pytest.approx(before.root_m, abs=1e-9)
    step = step_between(fitter.model, (root, local), (before.root_m, before.local_xyzw))
    assert np.abs(step).max() < 1e-6
