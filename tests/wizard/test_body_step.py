"""The step Body: stature, proportions of an odd wearer, and a room of another scale."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.skeleton import INDEX
from mocapd.calibrate.body_shape.body_observations import BodyObservations
from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.errors import InputError
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import FrameSet, Rig
from mocapd.wizard.body.body_step import BodyStep
from mocapd.wizard.colour.colour_solving import StrokeDrawing, solve_colours
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality
from mocapd.wizard.saving import calibration_of
from mocapd.wizard.step import Scene, StepState, Tell
from tests.tracking.profiles import shirt_tracker
from tests.tracking.stepping import Stepping
from tests.wizard.context import FakeContext, do
from tests.wizard.playing import playing
from tests.wizard.wearer import FPS_HZ, SimulatedWearer, wearer

pytestmark = pytest.mark.kernels

ARMS = [INDEX[s + bone] for s in ("left", "right") for bone in ("UpperArm", "LowerArm", "Hand")]


@pytest.fixture(scope="module")
def database(smaller_database: PoseDatabase) -> PoseDatabase:
    return smaller_database


@pytest.fixture(scope="module")
def person() -> SimulatedWearer:
    return wearer(odd=True)


@pytest.fixture(scope="module")
def bends(person: SimulatedWearer) -> list[FrameSet]:
    """One loop of the arm bends."""
    loop = round(person.truth.scenario.loop_s * FPS_HZ)
    return [person.frame_set(i) for i in range(loop)]


@pytest.fixture(scope="module")
def draft(person: SimulatedWearer) -> Draft:
    """Room and colours are done."""
    solved = solve_colours({n: StrokeDrawing(one) for n, one in person.scribbles.items()}, True, {})
    colours = {
        name: DraftColours(one.drawn.picture, one.W)
        for name, one in solved.cameras.items()
        if one.W is not None
    }
    return Draft(
        cameras=tuple(DraftCamera(c.name, "sim", c.size_px) for c in person.rig.cameras),
        rig=person.rig,
        extrinsics_quality=ExtrinsicsQuality("board", 0.3, {}, 0.2),
        floor_known=True,
        colours=colours,
        personal=solved.personal,
    )


def kept(context: FakeContext) -> Draft:
    """What is in the draft now."""
    return context.draft


def measured(
    context: FakeContext,
    person: SimulatedWearer,
    database: PoseDatabase,
    bends: list[FrameSet],
    m: float,
) -> BodyStep:
    """The step after this stature was typed and the wearer was measured."""

    def make(draft: Draft, _cache_dir: Path, _tell: Tell) -> ReadyTracker:
        known = calibration_of(replace(draft, factors=None)).assuming(1.75)
        return ReadyTracker(shirt_tracker(known, database), wearer_shape(known))

    step = BodyStep(context, make)
    step.enter()
    do(step, "stature", {"m": m})
    do(step, "measure", {})
    step.tick(0)
    with playing(context, lambda number: bends[number % len(bends)], 1.0 / FPS_HZ):
        assert context.run_job(step)
    return step


def test_proportions_of_an_odd_wearer(
    tmp_path: Path,
    person: SimulatedWearer,
    draft: Draft,
    database: PoseDatabase,
    bends: list[FrameSet],
) -> None:
    context = FakeContext(tmp_path, draft)
    step = measured(context, person, database, bends, person.stature_m)
    view = step.view()
    assert view.state is StepState.DONE
    assert view.problems == ()
    factors = context.draft.factors
    assert factors is not None
    np.testing.assert_allclose(factors[:4], person.factors[:4], rtol=0.05)
    np.testing.assert_allclose(factors, person.factors, rtol=0.12)
    off, mean_off = np.abs(factors - person.factors), np.abs(1.0 - person.factors)
    assert off[:4].mean() < 0.6 * mean_off[:4].mean()
    usual, mine = view.details["usual_cm"], view.details["lengths_cm"]
    assert mine["forearm"] < usual["forearm"]  # type: ignore[index]
    assert len(view.pictures) == 2
    assert context.draft.stature_m == person.stature_m
    # another stature makes them void
    do(step, "stature", {"m": 1.8})
    assert kept(context).factors is None
    assert step.view().state is StepState.WAITING


def test_every_camera_has_its_picture_though_the_last_frame_of_one_came_too_late(
    person: SimulatedWearer, draft: Draft, database: PoseDatabase, bends: list[FrameSet]
) -> None:
    known = calibration_of(replace(draft, stature_m=person.stature_m))
    tracker = Stepping(shirt_tracker(known, database), wearer_shape(known))
    observations = BodyObservations(build_model(person.stature_m), person.rig.cameras, every_s=0.0)
    for frames in bends[:6]:
        observations.add(tracker.step(frames), frames)
    left = FrameSet(bends[6].t_ns, {"left": bends[6].frames["left"]})
    assert observations.add(tracker.step(left), left)
    assert set(observations.pictures) == {"left", "right"}
    shown = observations.observations[observations.pictured]
    assert shown.t_ns == bends[5].t_ns
    assert observations.observations[-1].t_ns == left.t_ns


def test_a_stature_that_the_room_contradicts_is_told_with_its_likely_cause(
    tmp_path: Path,
    person: SimulatedWearer,
    draft: Draft,
    database: PoseDatabase,
    bends: list[FrameSet],
) -> None:
    context = FakeContext(tmp_path, draft)
    step = measured(context, person, database, bends, 1.12 * person.stature_m)
    view = step.view()
    assert view.state is StepState.DONE  # it is the person's to decide
    assert len(view.problems) == 1
    assert "less than the 1.90 m that you typed" in view.problems[0].what
    assert "correct the stature" in view.problems[0].fix
    assert "ruler" in view.problems[0].fix


def test_a_tracker_starts_nearer_from_measured_proportions(
    person: SimulatedWearer, draft: Draft, database: PoseDatabase, bends: list[FrameSet]
) -> None:
    known = calibration_of(replace(draft, stature_m=person.stature_m, factors=person.factors))

    def tracker(factors: np.ndarray | None) -> Stepping:
        mine = replace(known, wearer=replace(known.wearer, shape_factors=factors))
        return Stepping(shirt_tracker(mine, database), wearer_shape(mine))

    def error_m(one: Stepping) -> float:
        """Of the arms' joints over the first frames in which the wearer is known."""
        errors = []
        for frames in bends[:10]:
            body = one.step(frames).body
            if body.joints_m is not None:
                truth = person.truth.at((frames.t_ns - 1_000_000_000) / 1e9).joints_m
                errors.append(np.linalg.norm(body.joints_m - truth, axis=1)[ARMS].mean())
        return float(np.mean(errors))

    def shape_error_m(one: Stepping) -> float:
        return float(np.abs(one.skeleton.rest_m - person.truth.skeleton.rest_m)[ARMS].mean())

    assert known.wearer.shape_factors is person.factors
    given, unknown = tracker(person.factors), tracker(None)
    np.testing.assert_allclose(given.skeleton.rest_m, person.truth.skeleton.rest_m, atol=1e-9)
    assert error_m(given) < error_m(unknown)
    assert shape_error_m(given) < 0.5 * shape_error_m(unknown)
    given.reset()
    np.testing.assert_allclose(given.skeleton.rest_m, person.truth.skeleton.rest_m, atol=1e-9)


def test_a_stature_is_asked_for_and_checked(tmp_path: Path, draft: Draft) -> None:
    context = FakeContext(tmp_path, draft)
    step = BodyStep(context)
    step.enter()
    assert context.scenes == [Scene.ARM_BENDS]
    assert "how tall" in step.view().sentence
    for bad in (None, "1.8", True, float("nan"), 0.7, 2.4, 175):
        with pytest.raises(InputError, match="stature"):
            do(step, "stature", {"m": bad})
    with pytest.raises(InputError, match="not known"):
        do(step, "measure", {})
    with pytest.raises(InputError, match="not known"):
        do(step, "skip", {})
    assert kept(context).stature_m is None
    do(step, "stature", {"m": 1.62})
    assert kept(context).stature_m == 1.62
    view = step.view()
    assert view.state is StepState.WAITING
    assert view.details["can_measure"]
    do(step, "skip", {})
    assert step.view().state is StepState.DONE
    assert context.draft.factors is None


@pytest.mark.parametrize(
    ("lacking", "why"),
    [
        ({"rig": None}, "the room is not known"),
        ({"colours": {}}, "the colours are not known"),
        ({"rig": "one"}, "one camera cannot separate size from distance"),
    ],
)
def test_where_nothing_can_be_measured_the_stature_is_enough(
    tmp_path: Path, draft: Draft, lacking: dict[str, object], why: str
) -> None:
    if lacking.get("rig") == "one":
        assert draft.rig is not None
        lacking = {"rig": Rig(draft.rig.cameras[:1])}
    context = FakeContext(tmp_path, replace(draft, **lacking))  # type: ignore[arg-type]
    step = BodyStep(context)
    step.enter()
    do(step, "stature", {"m": 1.7})
    view = step.view()
    assert view.state is StepState.DONE
    assert why in view.sentence
    with pytest.raises(InputError, match=why):
        do(step, "measure", {})


def test_leaving_ends_the_measurement(
    tmp_path: Path, draft: Draft, person: SimulatedWearer, database: PoseDatabase
) -> None:
    known = Calibration(
        person.rig, Wearer(person.stature_m), ShirtColours(white_balance=person.scribbles)
    )

    def make(_draft: Draft, _cache_dir: Path, _tell: Tell) -> ReadyTracker:
        step.leave()
        return ReadyTracker(shirt_tracker(known, database), wearer_shape(known))

    context = FakeContext(tmp_path, draft)
    step = BodyStep(context, make)
    step.enter()
    do(step, "stature", {"m": 1.7})
    do(step, "measure", {})
    step.tick(0)
    assert context.run_job(step)  # nobody feeds the hub, yet it ends
    assert context.draft.factors is None
