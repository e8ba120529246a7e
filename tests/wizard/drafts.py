"""Drafts in which every step is done, of two small webcams, and how two drafts are compared."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace

import numpy as np

from mocapd.body.shape import N_FACTORS
from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.capture.webcam.controls import Controls
from mocapd.types import Camera, LabelledPicture, Rig
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, ExtrinsicsQuality

SIZE_PX = (64, 48)
NAMES = ("cam0", "cam1")
PORTS = {"cam0": "1-1", "cam1": "1-2"}


def source_of(name: str, port: str) -> str:
    """Webcams of one model, each with a serial number."""
    return f"usb:{port}:046d:0825:{name}"


def full_draft() -> Draft:
    """Every step is done."""
    K = np.array([[60.0, 0.0, 32.0], [0.0, 61.0, 24.0], [0.0, 0.0, 1.0]])
    rig = Rig(
        tuple(
            Camera(
                name,
                SIZE_PX,
                K,
                np.array([0.1, 0.0, 0.0, 0.0, 0.0]),
                np.diag([-1.0, -1.0, 1.0]),
                np.array([i - 0.5, 1.0, 3.0]),
            )
            for i, name in enumerate(NAMES)
        )
    )
    strokes = np.zeros(SIZE_PX[::-1], np.uint8)
    for colour in range(1, 11):
        strokes[5:15, 5 * colour : 5 * colour + 4] = colour
    pixels = np.random.default_rng(1).integers(0, 255, (*SIZE_PX[::-1], 3), dtype=np.uint8)
    return Draft(
        cameras=tuple(
            DraftCamera(
                name, source_of(name, PORTS[name]), SIZE_PX, 30.0, Controls(exposure=150), "shelf"
            )
            for name in NAMES
        ),
        board=BoardSpec(BoardKind.CHARUCO, 5, 7, 0.05, 0.0375, two_sided=True),
        intrinsics={
            camera.name: Intrinsics(
                SIZE_PX, K, camera.dist, np.array([True, True, False, False, False]),
                0.25, 0.3, tuple(range(12)), (), 0.001,
            )
            for camera in rig.cameras
        },
        rig=rig,
        extrinsics_quality=ExtrinsicsQuality("wearer", float("nan"), {"cam0": 0.3, "cam1": 0.4}, 0.5),
        floor_known=True,
        colours={name: DraftColours(LabelledPicture(pixels, strokes), np.eye(3) * 1.1) for name in NAMES},
        personal=True,
        stature_m=1.72,
        factors=np.linspace(0.9, 1.1, N_FACTORS).round(4),
    )  # fmt: skip


def drafted() -> Draft:
    """All of it, with moments of the board and a camera whose address has a password."""
    draft = full_draft()
    one, other = draft.cameras
    corners_px = np.random.default_rng(2).uniform(0, 48, (24, 2)).round(3)
    views = {7: BoardView(7, np.arange(24), corners_px, 0.4, back=True)}
    return replace(
        draft,
        cameras=(one, replace(other, source="rtsp://admin:hunter2@10.0.0.7/live")),
        board_views={"cam0": views},
    )


def begun(draft: Draft) -> Draft:
    """What the next setup begins with: the same cameras, nothing known."""
    return Draft(cameras=draft.cameras)


def same(a: object, b: object) -> bool:
    """Whether two drafts, or parts of them, hold the same."""
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if is_dataclass(a):
        return type(a) is type(b) and all(
            same(getattr(a, field.name), getattr(b, field.name)) for field in fields(a)
        )
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, float | np.ndarray):
        return np.array_equal(a, b, equal_nan=isinstance(a, float))  # type: ignore[arg-type]
    return a == b
