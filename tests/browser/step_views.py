"""What each step of the setup shows, made by hand: the page can be looked at without cameras and trackers."""

import dataclasses
from collections.abc import Mapping

import numpy as np

from mocapd.calibrate.extrinsics.visible_floor import rig_advice, visible_floor
from mocapd.errors import Problem
from mocapd.types import Rig
from mocapd.wizard.extrinsics.rig_plan import area_shapes, plan_of_cameras
from mocapd.wizard.step import Json, StepState, StepView
from mocapd.wizard.step_names import StepName
from mocapd.wizard.wizard_view import WizardView
from tests.geometry.rigs import looking_at

NAMES = ("cam0", "cam1")
SAVED = "/home/me/.local/state/mocapd/calibration.toml"
PAIR = Rig(
    tuple(
        looking_at(name, np.array([x_m, 1.5, 3.0]), np.array([0.0, 1.0, 0.0]))
        for name, x_m in zip(NAMES, (-1.6, 1.5), strict=True)
    )
)


class ShownWizard:
    """In place of the wizard: shows what it is given, and keeps what the page says."""

    def __init__(self) -> None:
        self.shown = wizard_view(StepName.CAMERAS, cameras())
        self.heard: list[tuple[str, Mapping[str, object]]] = []

    def show(self, step: StepName, view: StepView, **changes: object) -> None:
        self.shown = dataclasses.replace(wizard_view(step, view), **changes)  # type: ignore[arg-type]

    def view(self) -> WizardView:
        return self.shown

    def send(self, verb: str, args: Mapping[str, object]) -> None:
        self.heard.append((verb, args))

    def picture(self, key: str) -> bytes | None:
        del key
        return None


def wizard_view(step: StepName, view: StepView) -> WizardView:
    """All steps before it are done."""
    done = frozenset(list(StepName)[: list(StepName).index(step)])
    return WizardView(1, step, done, view, None, saved=False, ended=False)


def cameras() -> StepView:
    def row(name: str) -> Json:
        return {
            "id": name, "label": "", "source": "usb:1-3:046d:0825:", "size_px": [640, 480], "fps_hz": 30.0,
            "taken": True, "phase": "locked", "share": 1.0, "lockable": True, "offer": None,
            "measured_hz": 29.9, "controls": {"exposure": 156, "gain": 40},
        }  # fmt: skip

    return StepView(
        StepState.DONE,
        "2 cameras are ready and locked. Go on.",
        1.0,
        details={"cameras": [row(name) for name in NAMES], "others": [], "kept": None, "moved": []},
    )


def lens(views: int = 7, state: StepState = StepState.WAITING) -> StepView:
    board: Json = {
        "kind": "charuco", "columns": 8, "rows": 6, "square_mm": 45.0, "marker_mm": 33.0, "dictionary": "DICT_4X4_50",
        "dictionaries": ["DICT_4X4_50"], "inverted": False, "legacy": False, "two_sided": False,
        "fewest": {"charuco": 3, "chessboard": 3}, "most": 100,
    }  # fmt: skip
    row: Json = {
        "name": "cam0", "views": views, "covered": 0.6, "lens": None, "so_far": None, "offered": None, "taken": False,
    }  # fmt: skip
    return StepView(
        state,
        "Show the board to cam0: tilt it to the left.",
        0.4,
        details={"board": board, "note": "", "cameras": {"cam0": row}, "finishable": True},
    )


def room(state: StepState = StepState.WAITING, stage: str = "floor") -> StepView:
    done = stage == "done"
    quality: Json = {
        "rms_px": 0.31, "play_area_cm": 0.42, "cameras": {name: {"rms_px": 0.3} for name in NAMES},
    }  # fmt: skip
    boards_m = [[0.3, 1.0, 0.2], [-0.4, 1.2, 0.1], [0.1, 0.9, -0.6]]
    advice = tuple(rig_advice(visible_floor(PAIR), 2)) if done else ()
    return StepView(
        state,
        "The room is known. Go on." if done else "Lay the board flat on the floor where both cameras see it.",
        1.0 if done else 0.8,
        advice,
        area_shapes(PAIR) if done else {},
        {
            "method": "board", "methods": ["board", "wearer"], "stage": stage, "solving": False, "moments": 9,
            "enough": 12, "names": {name: name for name in NAMES}, "can_solve": False, "at_rest": True,
            "pairs": [{"a": "cam0", "b": "cam1", "shared": 9}], "can_skip_floor": True, "floor_known": done,
            "quality": quality, "plan": {**plan_of_cameras(PAIR), "boards_m": boards_m} if done else None,
        },
    )  # fmt: skip


def colour() -> StepView:
    colours = [
        {"id": i, "name": f"colour {i}", "rgb": [25 * i, 255 - 25 * i, 120]} for i in range(1, 11)
    ]
    return StepView(
        StepState.WAITING,
        "Press “Take the pictures”, then stand with your arms out.",
        details={
            "phase": "live", "countdown": 0, "proposing": False, "colours": colours, "cameras": {},
            "personal": {"wanted": False, "missing": []},
        },
    )  # fmt: skip


def body(measured: bool = False) -> StepView:
    return StepView(
        StepState.DONE if measured else StepState.WAITING,
        "Compare the lines with your body: measure again if they are off, or go on."
        if measured
        else "Press “Measure”, stand with both arms out, then bend and stretch your elbows.",
        1.0 if measured else 0.3,
        details={
            "stature_m": 1.75, "has_shirt": True, "measuring": False, "can_measure": True, "why_not": "",
            "measured": measured, "lengths_cm": {"upper arm": 29.0}, "usual_cm": {"upper arm": 29.0},
            "pictures": [],
        },
    )  # fmt: skip


def check(
    phase: str = "judged", saved: str | None = None, following: str = "mocapd run"
) -> StepView:
    verdicts: Json = [
        {
            "camera": name, "grade": "good", "reprojection_px": 1.2, "cm": 0.6, "match": 0.92, "seen": 1.0,
            "dropped": 0.0, "rate_hz": 29.9,
        }
        for name in NAMES
    ]  # fmt: skip
    sentences = {
        "judged": "All is well: save it.",
        "leaving": "Step out of every camera's picture.",
        "seeking": "Come back, stand upright, and face the cameras.",
    }
    return StepView(
        StepState.DONE if phase == "judged" else StepState.WAITING,
        sentences[phase],
        1.0,
        (Problem("the person leans by 24 degrees", "the floor", "lay the board flat"),)
        if phase == "judged"
        else (),
        details={
            "phase": phase, "tracking": "live", "rate_hz": 30.0, "verdicts": verdicts if phase == "judged" else [],
            "saved": saved, "next_command": following, "has_shirt": True,
        },
    )  # fmt: skip


PAGES: Mapping[str, tuple[StepName, StepView]] = {
    "cameras": (StepName.CAMERAS, cameras()),
    "lens": (StepName.LENS, lens()),
    "room": (StepName.ROOM, room()),
    "room_done": (StepName.ROOM, room(StepState.DONE, "done")),
    "colour": (StepName.COLOUR, colour()),
    "body": (StepName.BODY, body()),
    "check": (StepName.CHECK, check()),
}
