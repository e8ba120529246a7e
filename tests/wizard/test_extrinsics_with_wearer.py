"""The room without a board: what must be known first, a simulated wearer, and one whom nobody sees."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibrate.self_calibration.joint_solver import SelfCalibrationParams
from mocapd.calibrate.self_calibration.walk_coverage import WalkParams
from mocapd.errors import InputError
from mocapd.geometry.camera_model import centre
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.types import Frame, FrameSet
from mocapd.wizard.colour.colour_solving import StrokeDrawing, solve_colours
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours
from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep
from mocapd.wizard.extrinsics.extrinsics_with_wearer import ExtrinsicsWithWearer
from mocapd.wizard.step import Scene, StepState
from tests.wizard.context import FakeContext, do
from tests.wizard.playing import playing
from tests.wizard.wearer import FPS_HZ, SimulatedWearer, wearer

SHORT = WalkParams(
    good_s=3.0, facings=1, places=1, patience_s=600.0,
    extrinsics=SelfCalibrationParams(keyframes=14, rounds=6, averaged=2, polish=1),
)  # fmt: skip

EVERY = 3  # of the simulated frame sets one is shown: 10 a second are followed as well, for less


@pytest.fixture(scope="module")
def database(smaller_database: PoseDatabase) -> PoseDatabase:
    return smaller_database


@pytest.fixture(scope="module")
def draft() -> Draft:
    """Lenses, colours and stature are known, the room is not."""
    person = wearer()
    solved = solve_colours({n: StrokeDrawing(one) for n, one in person.scribbles.items()}, True, {})
    return Draft(
        cameras=tuple(DraftCamera(c.name, "sim", c.size_px) for c in person.rig.cameras),
        intrinsics={
            c.name: Intrinsics(c.size_px, c.K, c.dist, np.ones(5, bool), 0.2, 0.2, (), (), 0.002)
            for c in person.rig.cameras
        },
        colours={
            name: DraftColours(one.drawn.picture, one.W)
            for name, one in solved.cameras.items()
            if one.W is not None
        },
        personal=solved.personal,
        stature_m=person.stature_m,
    )


def walking(
    context: FakeContext, database: PoseDatabase, params: WalkParams = SHORT
) -> ExtrinsicsWithWearer:
    """The wearer was asked to walk, and the job waits."""
    step = ExtrinsicsWithWearer(context, lambda _cache, _tell: database, params)
    step.enter()
    do(step, "walk", {})
    step.tick(0)
    return step


def kept(context: FakeContext) -> Draft:
    """What is in the draft now."""
    return context.draft


def bends(person: SimulatedWearer) -> Callable[[int], FrameSet]:
    """The loop of arm bends."""
    loop = round(person.truth.scenario.loop_s * FPS_HZ)
    made = [person.frame_set(i) for i in range(0, loop, EVERY)]
    return lambda number: made[number % len(made)]


def test_the_room_of_a_wearer(tmp_path: Path, draft: Draft, database: PoseDatabase) -> None:
    person = wearer()
    context = FakeContext(tmp_path, draft)
    step = walking(context, database)
    assert context.scenes == [Scene.MOVING]
    assert step.view().state is StepState.WORKING
    with playing(context, bends(person), EVERY / FPS_HZ):
        context.run_job(step)
    view = step.view()
    assert view.state is StepState.DONE, view.problems
    assert json.dumps(dict(view.details))
    shares = [share for _, share in context.told]
    assert shares == sorted(shares)
    found = kept(context)
    assert found.rig is not None
    assert found.extrinsics_quality is not None
    assert (found.extrinsics_quality.method, found.floor_known) == ("wearer", True)
    assert set(found.extrinsics_quality.camera_rms_px) == set(found.rig.names)
    apart_m = [
        np.linalg.norm(centre(rig.cameras[1]) - centre(rig.cameras[0]))
        for rig in (found.rig, person.rig)
    ]
    # three seconds on the spot, small pictures: the figures are those of evaluate.extrinsics_from_body
    assert apart_m[0] == pytest.approx(apart_m[1], rel=0.25)
    for camera, true in zip(found.rig.cameras, person.rig.cameras, strict=True):
        assert centre(camera)[1] == pytest.approx(centre(true)[1], abs=0.3)
    # a second walk begins at the room that is there, and can be ended without changing it
    do(step, "walk", {})
    step.tick(0)
    do(step, "stop", {})
    context.run_job(step)
    assert kept(context).rig is found.rig
    assert step.view().state is StepState.DONE


def test_a_wearer_whom_nobody_sees(tmp_path: Path, draft: Draft, database: PoseDatabase) -> None:
    context = FakeContext(tmp_path, draft)
    step = walking(context, database, replace(SHORT, patience_s=1.0))
    black = {c.id: np.zeros((*c.size_px[::-1], 3), np.uint8) for c in draft.cameras}
    with playing(
        context,
        lambda number: FrameSet(
            0, {name: Frame(name, number, 0, pixels) for name, pixels in black.items()}
        ),
        EVERY / FPS_HZ,
    ):
        context.run_job(step)
    view = step.view()
    assert view.state is StepState.FAILED
    assert "0 s" in view.problems[0].what
    assert kept(context) is draft
    assert view.details["actions"] == [{"verb": "walk", "text": "Start"}]


@pytest.mark.parametrize(
    ("change", "where"), [({"colours": {}}, "Colours"), ({"stature_m": None}, "Body")]
)
def test_what_must_be_known_first(
    tmp_path: Path, draft: Draft, change: dict[str, object], where: str
) -> None:
    context = FakeContext(tmp_path, replace(draft, **change))  # type: ignore[arg-type]
    step = ExtrinsicsStep(context)
    step.enter()
    do(step, "method", {"method": "wearer"})
    view = step.view()
    assert (view.details["method"], view.details["actions"]) == ("wearer", [])
    assert f"the step {where} first" in view.sentence
    with pytest.raises(InputError, match=where):
        do(step, "walk", {})
