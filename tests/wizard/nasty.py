"""What a page can say and should not: each nasty value in each argument of each verb of each step.

For the tests and for longer runs: `attack_each` and `attack_at_random` count what became of it. Anything
that is not a named error comes out of them.
"""

import base64
import struct
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import cv2
import msgspec
import numpy as np

from mocapd.config.sections import TrackerSection
from mocapd.errors import CannotCreateError, InputError, MocapdError
from mocapd.session.tracker_setup import ReadyTracker
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.types import Bytes
from mocapd.web.shown_json import as_json
from mocapd.wizard.body.body_step import BodyStep
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.cameras_step import CamerasStep
from mocapd.wizard.cameras.same_port import AsksForPorts, PortChange
from mocapd.wizard.check.check_settings import CheckSettings
from mocapd.wizard.check.check_step import CheckStep
from mocapd.wizard.colour.colour_step import ColourStep
from mocapd.wizard.context import Context, Step
from mocapd.wizard.draft import Draft
from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep
from mocapd.wizard.intrinsics.intrinsics_step import IntrinsicsStep
from mocapd.wizard.newest_body import NewestBody
from mocapd.wizard.step import Tell
from mocapd.wizard.step_names import StepName
from tests.wizard.context import FakeContext, do
from tests.wizard.drafts import SIZE_PX, full_draft
from tests.wizard.fake_webcam import FakeWebcam

DEEP: object = None
for _ in range(2000):
    DEEP = [DEEP]

VALUES: tuple[object, ...] = (
    None, True, False, 0, 1, -1, 3, 101, 20000, 2**31, 2**63, 2**64, 10**400, -(10**400),
    0.0, -0.0, 1e-320, 0.5, 1.7, 1e9, 1e308, float("nan"), float("inf"), float("-inf"),
    "", "x", "cam0", "cam1", "wearer", "chessboard", "DICT_4X4_50", "lens", "é", "\x00", "\ud800",
    "../..", "10" * 4000, "rtsp://a:secret@b/", [], [1], [64, 48], [0, 0], [10**400, 1], ["a", "b"],
    [float("nan"), 1], {}, {"a": 1}, {"camera": "cam0"}, b"x", DEEP, [1] * 10_000,
)  # fmt: skip


def png_of(strokes: Bytes) -> str:
    """As the page sends it."""
    return base64.b64encode(cv2.imencode(".png", strokes)[1].tobytes()).decode()


def _chunk(name: bytes, data: bytes, claims: int | None = None) -> bytes:
    length = len(data) if claims is None else claims
    return struct.pack(">I", length) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _png(width: int, height: int, bits: int = 8, colour: int = 0, claims: int | None = None) -> str:
    header = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    data = zlib.compress(bytes(64))
    made = b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + _chunk(b"IDAT", data, claims)
    return base64.b64encode(made + _chunk(b"IEND", b"")).decode()


def _jpeg() -> str:
    grey = np.zeros(SIZE_PX[::-1], np.uint8)
    return base64.b64encode(cv2.imencode(".jpg", grey)[1].tobytes()).decode()


def pictures() -> Iterator[str]:
    """Strokes that are none, and degenerate ones."""
    w, h = SIZE_PX
    yield from (_png(65536, 65536), _png(w, h, claims=0xFF000000), _png(w, h, 16), _png(w, h, 8, 9))
    yield from (
        _png(w, h),
        _png(0, 0),
        _jpeg(),
        "A",
        "====",
        "é",
        base64.b64encode(b"PNG").decode(),
    )
    plain = np.zeros((h, w), np.uint8)
    yield png_of(plain)
    yield png_of(np.zeros((h, w + 1), np.uint8))
    yield png_of(plain + 11)
    yield png_of(np.zeros((h, w, 3), np.uint8))
    for colour in (1, 10):
        yield png_of(plain + colour)  # all of the picture
        one = plain.copy()
        one[3, 4] = colour
        yield png_of(one)
        one[:, 5] = colour
        yield png_of(one)
    random = np.random.default_rng(5)
    yield png_of(random.integers(0, 11, (h, w), dtype=np.uint8))
    bars = np.repeat(np.arange(w, dtype=np.uint8)[None] * 11 // w, h, axis=0)
    yield png_of(np.ascontiguousarray(bars))


RIGHT: Mapping[str, object] = {
    "camera": "cam0", "name": "shelf", "size_px": [64, 48], "fps_hz": 30.0, "same": True,
    "mm": 100, "png_base64": png_of(np.ones(SIZE_PX[::-1], np.uint8)), "m": 1.7, "step": "lens",
    "shirt": True,
}  # fmt: skip
"""An argument of each name that is taken."""


def no_database(cache_dir: Path, tell: Tell) -> PoseDatabase:
    """A cache that cannot be written: nothing is proposed."""
    raise CannotCreateError("the cache cannot be written", str(cache_dir), "make room")


def no_tracker(draft: Draft, cache_dir: Path, tell: Tell) -> ReadyTracker:
    """Nobody is seen."""
    raise InputError("the wearer was not seen", "body", "stand there")


def makers(webcams: tuple[FakeWebcam, ...]) -> Mapping[StepName, Callable[[Context], Step]]:
    """Each step, on small webcams, without what takes seconds."""
    cameras = full_draft().cameras
    locks = CameraLocks(webcams)

    def died(error: BaseException) -> None:
        raise error

    return {
        StepName.CAMERAS: lambda context: AsksForPorts(
            context,
            lambda inner: CamerasStep(inner, cameras, lambda: (), locks),
            [PortChange("cam1", cameras[1].source, "usb:9-9:046d:0825:cam1")],
        ),
        StepName.LENS: IntrinsicsStep,
        StepName.ROOM: ExtrinsicsStep,
        StepName.COLOUR: lambda context: ColourStep(context, no_database),
        StepName.BODY: lambda context: BodyStep(context, no_tracker),
        StepName.CHECK: lambda context: CheckStep(
            context, CheckSettings(TrackerSection()), NewestBody(), died
        ),
    }


def arguments(kind: type[msgspec.Struct], nasty: object, name: str) -> dict[str, object]:
    """What a verb takes, with one argument that is nasty."""
    fields = msgspec.structs.fields(kind)
    given = {field.name: RIGHT[field.name] for field in fields if field.required}
    return given | {name: nasty}


class Attack:
    """One step after another, on noise; counts what is taken and refused."""

    def __init__(self, folder: Path, name: StepName, draft: Draft) -> None:
        self.count: Counter[str] = Counter()
        self._name, self._draft = name, draft
        self._make = makers(tuple(FakeWebcam(camera.id) for camera in draft.cameras))[name]
        self.context = FakeContext(folder, draft)
        random = np.random.default_rng(6)
        shape = (*SIZE_PX[::-1], 3)
        self._noise = {c.id: random.integers(0, 255, shape, np.uint8) for c in draft.cameras}
        self.begin()

    def begin(self) -> None:
        """The step as it is when it is entered."""
        self.context = FakeContext(self.context.state_dir.parent, self._draft)
        self.step = self._make(self.context)
        self.step.enter()

    def say(self, verb: str, args: Mapping[str, object]) -> None:
        """A command, and what becomes of it in the next ticks and jobs."""
        try:
            do(self.step, verb, args)
            self.count["taken"] += 1
        except MocapdError as error:
            self.count["refused"] += 1
            as_json([error.what, error.where, error.fix])
            return  # nothing has changed
        for _ in range(2):
            for camera, pixels in self._noise.items():
                self.context.put(camera, pixels)
            self.step.tick(self.context.now_ns)
            if self._name not in (StepName.CHECK, StepName.ROOM):  # whose jobs take seconds
                self.context.run_job(self.step)
            self.context.now_ns += 50_000_000
        as_json(self.step.view().details)


def attack_each(folder: Path, name: StepName, draft: Draft, wearer: bool = False) -> Counter[str]:
    """Every nasty value in every argument of every verb of one step; `wearer`: of the room without board."""
    attack = Attack(folder, name, draft)
    if wearer:
        attack.say("method", {"method": "wearer"})
    for verb, kind in dict(attack.step.verbs).items():
        fields = [field.name for field in msgspec.structs.fields(kind)]
        for field in fields:
            more = tuple(pictures()) if field == "png_base64" else ()
            for nasty in (*VALUES, *more):
                attack.say(verb, arguments(kind, nasty, field))
            attack.say(verb, {})
        attack.say(verb, arguments(kind, VALUES, "nobody_asked_for"))
        if name is StepName.ROOM:
            attack.begin()
            attack.say("method", {"method": "wearer" if wearer else "board"})
    for verb in ("", "x" * 5000, "\ud800", "__class__", "view"):
        attack.say(verb, {})
    return attack.count


def attack_at_random(
    folder: Path, name: StepName, draft: Draft, commands: int, seed: int
) -> Counter[str]:
    """A random sequence of verbs of one step, with right and with nasty arguments."""
    attack = Attack(folder, name, draft)
    random = np.random.default_rng(seed)
    for _ in range(commands):
        verbs = dict(attack.step.verbs)
        verb = str(random.choice(list(verbs)))
        args: dict[str, object] = {}
        for field in msgspec.structs.fields(verbs[verb]):
            nasty = random.random() < 0.5 or field.name not in RIGHT
            args[field.name] = VALUES[random.integers(len(VALUES))] if nasty else RIGHT[field.name]
        attack.say(verb, args)
    return attack.count


def without_room(draft: Draft) -> Draft:
    """So that no tracker is prepared."""
    return replace(draft, rig=None, extrinsics_quality=None)
