"""What a page says may be refused, and is never deadly. The counts are printed: `pytest -s`."""

from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest

from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Frame, LabelledPicture
from mocapd.wizard.colour.colour_solving import StrokeDrawing, solve_colours
from mocapd.wizard.commands import OF_WIZARD
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard import Wizard
from tests.wizard.drafts import SIZE_PX, full_draft
from tests.wizard.fake_webcam import FakeWebcam
from tests.wizard.nasty import (
    RIGHT,
    VALUES,
    arguments,
    attack_at_random,
    attack_each,
    makers,
    without_room,
)

WAIT_S = 120.0


@pytest.mark.parametrize("name", list(StepName))
def test_no_value_of_any_argument_is_deadly(tmp_path: Path, name: StepName) -> None:
    count = attack_each(tmp_path, name, full_draft())
    print(f"{name}: {dict(count)}")
    assert count["refused"] > 0


def test_nor_of_the_room_without_a_board(tmp_path: Path) -> None:
    print(dict(attack_each(tmp_path, StepName.ROOM, without_room(full_draft()), wearer=True)))


@pytest.mark.parametrize("name", [one for one in StepName if one is not StepName.CHECK])
def test_nor_are_commands_in_any_order(tmp_path: Path, name: StepName) -> None:
    count = attack_at_random(tmp_path, name, without_room(full_draft()), 60, seed=8)
    print(f"{name}: {dict(count)}")


@pytest.fixture
def wizard(tmp_path: Path) -> Iterator[Wizard]:
    """All steps, in the wizard's own thread, on noise."""
    draft = without_room(full_draft())
    hub = FrameHub([camera.id for camera in draft.cameras])
    noise = np.random.default_rng(9).integers(0, 255, (*SIZE_PX[::-1], 3), np.uint8)
    for camera in draft.cameras:
        hub.put(Frame(camera.id, 1, 1, noise))
    died: list[BaseException] = []
    steps = makers(tuple(FakeWebcam(camera.id) for camera in draft.cameras))
    wizard = Wizard(hub, steps, dict, tmp_path, tmp_path, died.append, draft=draft)
    wizard.start()
    yield wizard
    assert wizard.stop(WAIT_S)
    assert not died


def test_the_wizard_goes_on_whatever_it_is_told(
    wizard: Wizard, caplog: pytest.LogCaptureFixture
) -> None:
    random = np.random.default_rng(10)
    said = 0
    for step in StepName:
        wizard.send("go", {"step": step.value})
        for verb, kind in OF_WIZARD.items():
            for field in msgspec.structs.fields(kind):
                for nasty in VALUES:
                    said += 1
                    wizard.send(verb, arguments(kind, nasty, field.name))
                    wizard.newer(wizard.view().serial, WAIT_S)
        for _ in range(20):
            said += 1
            nasty = VALUES[random.integers(len(VALUES))]
            wizard.send(str(random.choice(["freeze", "board", "name", "stature", "method", "lock"])),
                        {**RIGHT, "seconds": nasty, "columns": nasty, "m": nasty})  # fmt: skip
            wizard.newer(wizard.view().serial, WAIT_S)
    wizard.send("the last one")
    view = wizard.view()
    for _ in range(400):
        if view.refused is not None and "the last one" in view.refused.what:
            break
        view = wizard.newer(view.serial, WAIT_S)
    else:
        pytest.fail(f"the wizard does not answer: {view}")
    print(f"{said} commands")
    assert "a bug in mocapd" not in caplog.text


@pytest.mark.parametrize("seed", range(12))
def test_strokes_of_any_kind_on_any_picture_are_judged(seed: int) -> None:
    """Flat, black, noisy; lines, blots, single pixels, of few and of many colours."""
    random = np.random.default_rng(seed)
    w, h = SIZE_PX
    low, high = [(0, 1), (255, 256), (0, 256), (100, 104)][seed % 4]
    pixels = random.integers(low, high, (h, w, 3)).astype(np.uint8)
    strokes = np.zeros((h, w), np.uint8)
    for colour in random.permutation(np.arange(1, 11))[: random.integers(1, 11)]:
        x, y = random.integers(0, w - 1), random.integers(0, h - 1)
        strokes[y : y + random.integers(1, 20), x : x + random.integers(1, 20)] = colour
    solution = solve_colours(
        {"cam0": StrokeDrawing(LabelledPicture(pixels, strokes))}, bool(seed % 2), {}
    )
    for one in solution.cameras.values():
        assert one.W is None or np.isfinite(one.W).all()
