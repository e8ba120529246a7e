"""The step Colours: proposed strokes, drawn strokes, and strokes that cannot be right."""

import base64
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.capture.capture_folder import load_folder
from mocapd.errors import CannotCreateError, InputError
from mocapd.shirt.colour.from_pictures import colour_model, white_balance_of
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.shirt.colour.white_balance import frobenius_distance
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes
from mocapd.wizard.colour.colour_step import ColourStep
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.step import Scene, StepState, StepView, Tell
from tests.wizard.context import FakeContext, do
from tests.wizard.wearer import SimulatedWearer, wearer

pytestmark = pytest.mark.kernels

NAMES = standard_shirt().colour_names


@pytest.fixture(scope="module")
def database(smaller_database: PoseDatabase) -> PoseDatabase:
    return smaller_database


@pytest.fixture(scope="module")
def person() -> SimulatedWearer:
    return wearer()


@pytest.fixture
def context(tmp_path: Path, person: SimulatedWearer) -> FakeContext:
    cameras = tuple(DraftCamera(c.name, f"sim:{c.name}", c.size_px) for c in person.rig.cameras)
    return FakeContext(tmp_path, Draft(cameras=cameras, rig=person.rig, stature_m=person.stature_m))


def no_database(cache_dir: Path, tell: Tell) -> PoseDatabase:
    """A cache that cannot be written."""
    raise CannotCreateError("the cache cannot be written", str(cache_dir), "make room")


def frozen(step: ColourStep, context: FakeContext, pictures: Mapping[str, Bytes]) -> StepView:
    """After the pictures were taken and every job was done."""
    context.drive(step, pictures)
    do(step, "freeze", {"seconds": 0})
    context.drive(step, pictures, 0.3)
    return step.view()


def by_hand(context: FakeContext, person: SimulatedWearer) -> ColourStep:
    """A step that proposes nothing, with pictures taken."""
    step = ColourStep(context, no_database)
    step.enter()
    frozen(step, context, person.pictures)
    return step


def drawn(step: ColourStep, context: FakeContext, camera: str, strokes: Bytes) -> StepView:
    """After a page sent these strokes."""
    do(step, "strokes", {"camera": camera, "png_base64": png(strokes), "by": "page"})
    context.drive(step, {}, 0.1)
    return step.view()


def is_personal(context: FakeContext) -> bool:
    """Whether the draft has the own shirt's colours in use."""
    return context.draft.personal


def png(image: np.ndarray) -> str:
    return base64.b64encode(cv2.imencode(".png", image)[1].tobytes()).decode()


def test_proposed_strokes_give_the_light_of_a_users_own(
    context: FakeContext, person: SimulatedWearer, database: PoseDatabase
) -> None:
    step = ColourStep(context, lambda _folder, _tell: database)
    step.enter()
    assert context.scenes == [Scene.T_POSE]
    assert step.view().state is StepState.WAITING
    view = frozen(step, context, person.pictures)
    assert view.state is StepState.DONE
    assert set(context.draft.colours) == {"left", "right"}
    for name, mine in person.scribbles.items():
        own = white_balance_of(mine, colour_model(()), plain=False)
        found = context.draft.colours[name]
        assert frobenius_distance(found.W, own) < 0.3
        truth = standard_shirt().colour_of_patch[person.patch[name]]
        on = found.picture.labels > 0
        assert (found.picture.labels == truth)[on].mean() > 0.9
    assert context.draft.personal
    for camera in view.details["cameras"].values():  # type: ignore[attr-defined]
        for key in (camera["picture"], camera["strokes"], camera["seen"]):
            assert cv2.imdecode(np.frombuffer(view.pictures[key], np.uint8), -1) is not None


def test_before_the_room_is_known_each_camera_is_read_alone(
    context: FakeContext, person: SimulatedWearer, database: PoseDatabase
) -> None:
    context.draft = replace(context.draft, rig=None, stature_m=None)
    step = ColourStep(context, lambda _folder, _tell: database)
    step.enter()
    assert frozen(step, context, person.pictures).state is StepState.DONE
    for name, one in context.draft.colours.items():
        truth = standard_shirt().colour_of_patch[person.patch[name]]
        assert (one.picture.labels == truth)[one.picture.labels > 0].mean() > 0.85


def test_nobody_in_the_pictures_leaves_an_empty_canvas_to_draw_on(
    context: FakeContext, person: SimulatedWearer, database: PoseDatabase
) -> None:
    empty = {r.camera.name: r.picture(None, np.ones(2), noise_key=7) for r in person.renderers}
    step = ColourStep(context, lambda _folder, _tell: database)
    step.enter()
    view = frozen(step, context, empty)
    assert view.state is StepState.FAILED
    assert "no shirt was found" in view.problems[0].what
    assert "paint" in view.sentence
    assert not context.draft.colours


def test_without_a_proposal_it_is_drawn_by_hand(
    context: FakeContext, person: SimulatedWearer
) -> None:
    step = by_hand(context, person)
    assert "cannot be written" in step.view().problems[0].what
    view = drawn(step, context, "left", person.scribbles["left"].labels)
    assert view.state is StepState.DONE
    assert "right" in view.sentence  # where nothing is drawn yet
    view = drawn(step, context, "right", person.scribbles["right"].labels)
    assert view.state is StepState.DONE
    assert set(context.draft.colours) == {"left", "right"}


def test_three_of_ten_colours_are_refused_with_the_names_of_the_others(
    context: FakeContext, person: SimulatedWearer
) -> None:
    strokes = person.scribbles["left"].labels.copy()
    present = [k for k in range(1, 11) if (strokes == k).sum() > 30][:3]
    strokes[~np.isin(strokes, present)] = 0
    view = drawn(by_hand(context, person), context, "left", strokes)
    assert view.state is StepState.FAILED
    told = next(p for p in view.problems if p.where == "left")
    assert "only 3 of 10 colours" in told.what
    for k, name in enumerate(NAMES):
        assert (name in told.fix) == (k + 1 not in present)
    assert not context.draft.colours


def test_strokes_on_the_wrong_patch_are_named_and_marked(
    context: FakeContext, person: SimulatedWearer
) -> None:
    strokes = person.scribbles["left"].labels.copy()
    red, lime = strokes == 1, strokes == 4
    strokes[red], strokes[lime] = 4, 1
    step = by_hand(context, person)
    view = drawn(step, context, "left", strokes)
    assert view.state is StepState.FAILED
    told = " ".join(problem.what for problem in view.problems)
    assert "red lies on what looks lime" in told
    camera = view.details["cameras"]["left"]  # type: ignore[index]
    assert any(red[y, x] or lime[y, x] for x, y in camera["marks"])
    # mended, it goes on
    assert drawn(step, context, "left", person.scribbles["left"].labels).state is StepState.DONE


def test_what_is_no_picture_of_strokes_is_refused_and_nothing_changes(
    context: FakeContext, person: SimulatedWearer
) -> None:
    step = by_hand(context, person)
    good = person.scribbles["left"].labels
    drawn(step, context, "left", good)
    before = step.view()
    coloured = np.repeat(good[..., None], 3, axis=2)
    coloured[0, 0, 0] += 1
    for bad in ("?", png(good[:50]), png(good + 11), png(coloured), 7):
        with pytest.raises(InputError):
            do(step, "strokes", {"camera": "left", "png_base64": bad})
    with pytest.raises(InputError, match="no picture of 'middle'"):
        do(step, "strokes", {"camera": "middle", "png_base64": png(good)})
    with pytest.raises(InputError):
        do(step, "freeze", {"seconds": "soon"})
    context.drive(step, {})
    assert step.view().details == before.details
    # a canvas sends colour with equal channels
    grey = np.repeat(good[..., None], 4, axis=2)
    grey[..., 3] = 255
    assert drawn(step, context, "left", grey).state is StepState.DONE


def test_the_countdown_is_shown_and_a_camera_without_picture_is_named(
    context: FakeContext, person: SimulatedWearer
) -> None:
    step = ColourStep(context, no_database)
    step.enter()
    one = {"left": person.pictures["left"]}
    context.drive(step, one)
    do(step, "freeze", {})
    assert step.view().details["countdown"] == 3
    context.drive(step, one, 1.5)
    assert step.view().sentence.endswith(": 2")
    context.drive(step, one, 2.7)
    view = step.view()
    assert view.details["phase"] == "frozen"
    assert [problem.where for problem in view.problems if problem.where] != []
    assert set(view.details["cameras"]) == {"left"}  # type: ignore[call-overload]


def test_pages_know_strokes_that_they_drew_themselves(
    context: FakeContext, person: SimulatedWearer
) -> None:
    step = by_hand(context, person)
    first = step.view().details["cameras"]["left"]  # type: ignore[index]
    assert first["by"] == "mocapd"
    strokes = person.scribbles["left"].labels
    view = drawn(step, context, "left", strokes)
    camera = view.details["cameras"]["left"]  # type: ignore[index]
    assert camera["by"] == "page"
    assert camera["strokes"] != first["strokes"]
    sent = cv2.imdecode(np.frombuffer(view.pictures[camera["strokes"]], np.uint8), -1)
    np.testing.assert_array_equal(sent, strokes)


def test_the_own_shirts_colours_can_be_left_out_and_need_every_colour(
    context: FakeContext, person: SimulatedWearer
) -> None:
    step = by_hand(context, person)
    for name, mine in person.scribbles.items():
        drawn(step, context, name, mine.labels)
    assert is_personal(context)
    do(step, "personal", {"on": False})
    context.drive(step, {})
    assert not is_personal(context)
    do(step, "personal", {"on": True})
    for name, mine in person.scribbles.items():
        drawn(step, context, name, np.where(mine.labels == 10, 0, mine.labels).astype(np.uint8))
    view = step.view()
    assert view.state is StepState.DONE
    assert view.details["personal"] == {"wanted": True, "on": False, "missing": ["pink"]}
    assert not is_personal(context)


def test_it_shows_what_was_found_before(context: FakeContext, person: SimulatedWearer) -> None:
    step = by_hand(context, person)
    drawn(step, context, "left", person.scribbles["left"].labels)
    before = context.draft
    again = ColourStep(context, no_database)
    again.enter()
    context.drive(again, {})
    assert again.view().state is StepState.DONE
    np.testing.assert_array_equal(context.draft.colours["left"].W, before.colours["left"].W)


def test_a_recorded_pair_in_its_own_light(
    dev_captures: Callable[[str], Path], tmp_path: Path, database: PoseDatabase
) -> None:
    folder = load_folder(dev_captures("pair_office_traffic"))
    mine = {c.name: read_labelled(c.scribble) for c in folder.cameras if c.scribble is not None}
    cameras = tuple(DraftCamera(c.name, "file", c.size_px) for c in folder.rig.cameras)
    context = FakeContext(
        tmp_path, Draft(cameras=cameras, rig=folder.rig, stature_m=folder.stature_m)
    )
    step = ColourStep(context, lambda _folder, _tell: database)
    step.enter()
    view = frozen(step, context, {name: one.pixels for name, one in mine.items()})
    assert view.state is StepState.DONE
    for name, one in mine.items():
        own = white_balance_of(one, colour_model(()), plain=False)
        assert frobenius_distance(context.draft.colours[name].W, own) < 0.3
