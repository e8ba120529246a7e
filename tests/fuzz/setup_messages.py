"""What a page may say to a setup: every verb with good arguments, and ways to spoil them."""

import base64
import json
from collections.abc import Mapping

from mocapd.wizard.step_names import StepName
from tests.fuzz.damaged_pictures import png, strokes_on
from tests.wizard.drafts import SIZE_PX

Args = Mapping[str, object]

_PNG = base64.b64encode(png(strokes_on(SIZE_PX))).decode()
_BOARD: Args = {
    "kind": "charuco", "columns": 5, "rows": 7, "square_mm": 30.0, "marker_mm": 22.0, "dictionary": "DICT_4X4_50",
    "inverted": False, "legacy": False, "two_sided": True,
}  # fmt: skip
# By the step in which it is understood; those of "" are in every step
VERBS: Mapping[str, tuple[tuple[str, Args], ...]] = {
    "": (("go", {"step": "lens"}), ("next", {}), ("again", {})),
    StepName.CAMERAS: (
        ("leave_out", {"camera": "cam0"}),
        ("take_in", {"camera": "cam0"}),
        ("name", {"camera": "cam0", "name": "left"}),
        ("mode", {"camera": "cam0", "size_px": [640, 480], "fps_hz": 30.0}),
        ("lock", {"camera": "cam1"}),
        ("same_port", {"camera": "cam1", "same": True}),
    ),
    StepName.LENS: (
        ("board", _BOARD),
        ("board", {"kind": "chessboard", "columns": 4, "rows": 3, "square_mm": 30.0}),
        ("ruler", {"mm": 99.5}),
        ("use_saved", {"camera": "cam0"}),
        ("measure", {"camera": "cam0"}),
        ("finish", {}),
    ),
    StepName.ROOM: (
        ("method", {"method": "wearer"}),
        ("floor", {}),
        ("skip_floor", {}),
        ("solve", {}),
        ("walk", {}),
        ("stop", {}),
    ),
    StepName.COLOUR: (
        ("freeze", {"seconds": 0}),
        ("propose", {}),
        ("strokes", {"camera": "cam0", "png_base64": _PNG, "by": "page"}),
        ("personal", {"on": False}),
    ),
    StepName.BODY: (("stature", {"m": 1.75}), ("measure", {}), ("skip", {})),
    StepName.CHECK: (("measure", {}), ("save", {})),
}
STEPS = tuple(StepName)


def message(verb: str, args: Args) -> bytes:
    """As the page sends it."""
    return json.dumps({"verb": verb, "args": args}).encode()


def verbs_in(step: str) -> tuple[tuple[str, Args], ...]:
    """All that a step understands."""
    return VERBS[""] + VERBS[step]


def with_value(verb: str, args: Args, name: str, value: str) -> bytes:
    """The message with one argument of it as this text of JSON."""
    fields = ",".join(
        f"{json.dumps(key)}:{value if key == name else json.dumps(one)}"
        for key, one in {**args, name: None}.items()
    )
    return f'{{"verb":{json.dumps(verb)},"args":{{{fields}}}}}'.encode("utf-8", "surrogatepass")
