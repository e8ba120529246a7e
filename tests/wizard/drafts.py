"""A draft in which every step is done, of two small webcams."""

import numpy as np

from mocapd.body.shape import N_FACTORS
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.capture.webcam.controls import Controls
from mocapd.types import Camera, LabelledPicture, Rig
from mocapd.wizard.draft import Draft, DraftCamera, DraftColours, RoomQuality

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
        board=BoardSpec(BoardKind.CHARUCO, 5, 7, 0.05, 0.0375),
        lenses={
            camera.name: Intrinsics(
                SIZE_PX, K, camera.dist, np.array([True, True, False, False, False]),
                0.25, 0.3, tuple(range(12)), (), 0.001,
            )
            for camera in rig.cameras
        },
        rig=rig,
        room=RoomQuality("wearer", float("nan"), {"cam0": 0.3, "cam1": 0.4}, 0.5),
        floor_known=True,
        colours={name: DraftColours(LabelledPicture(pixels, strokes), np.eye(3) * 1.1) for name in NAMES},
        personal=True,
        stature_m=1.72,
        factors=np.linspace(0.9, 1.1, N_FACTORS).round(4),
    )  # fmt: skip
