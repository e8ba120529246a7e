"""Commands of the setup: nasty values in every argument, random sequences, and random strokes solved."""

import base64
import json
from dataclasses import dataclass
from random import Random

import numpy as np

from mocapd.types import Bytes, LabelledPicture
from mocapd.wizard.colour.colour_solving import StrokeDrawing, solve_colours
from mocapd.wizard.colour.stroke_images import decode_strokes
from mocapd.wizard.step_names import StepName
from tests.fuzz.damaged_pictures import png, sample, strokes_on
from tests.fuzz.mutations import JSON_VALUES, mistyped
from tests.fuzz.row import Attempt, Place, each_of
from tests.fuzz.setup_bench import SetupBench
from tests.fuzz.setup_messages import STEPS, VERBS, message, verbs_in, with_value

_MORE_VALUES = (
    "4", "5.0", "0.999", "29.9", "1001", "99999999999", '"cam0"', '"cam1"', '"chessboard"', '"charuco"', '"wearer"',
    '"check"', "[64,48]", "[64.0,48]", '"DICT_4X4_50"', '"DICT_ARUCO_ORIGINAL"', '"\\u00e9\\u00e9=="', '"AAAA"', '"2"',
)  # fmt: skip
_VALUES = (*JSON_VALUES, *_MORE_VALUES)
_VERBS_WRONG = (
    "",
    "\0",
    "é",
    "__init__",
    "command",
    "x" * 10_000,
    "Go",
    "go ",
    "begin",
    "take_over",
)
_PAIRS = ("2", "3", "4", "33", "500", "20000", "1e5")


@dataclass(frozen=True, slots=True)
class _Case:
    step: StepName
    message: bytes


def values(place: Place) -> Attempt:
    """Each nasty value in each argument of each verb, and verbs that there are not."""

    def take(case: _Case) -> bool:
        bench = SetupBench(place.folder, case.step)
        try:
            if case.step is StepName.COLOUR:
                bench.do(message("freeze", {"seconds": 0}))
            return bench.do(case.message)
        finally:
            bench.close()

    assert take(_Case(StepName.LENS, message(*VERBS[StepName.LENS][0])))
    assert take(_Case(StepName.COLOUR, message(*VERBS[StepName.COLOUR][2])))
    return each_of(_cases(), take)


def number_of_values() -> int:
    """How many there are."""
    return len(_cases())


def _cases() -> list[_Case]:
    cases = []
    for step in STEPS:
        own = VERBS[step] if step is not StepName.CAMERAS else verbs_in(step)
        for verb, args in own:
            for name in args or {"x": 0}:
                cases += [_Case(step, with_value(verb, args, name, value)) for value in _VALUES]
            cases += [
                _Case(step, f'{{"verb":{json.dumps(verb)},"args":{value}}}'.encode())
                for value in ("[]", "null", "{}", '{"":1}', "1", '"x"')
            ]
        cases += [_Case(step, message(verb, {"camera": "cam0"})) for verb in _VERBS_WRONG]
    for kind in ("chessboard", "charuco"):
        for columns in _PAIRS:
            cases += [
                _Case(
                    StepName.LENS,
                    f'{{"verb":"board","args":{{"kind":"{kind}","columns":{columns},"rows":{rows}}}}}'.encode(),
                )
                for rows in _PAIRS
            ]
    return cases


def sequences(place: Place) -> Attempt:
    """Commands one after the other, from step to step, some of them spoilt."""

    def attempt(random: Random, number: int) -> bool:
        step = random.choice(STEPS)
        bench = SetupBench(place.folder, step)
        try:
            took = [bench.do(_some(random, bench)) for _ in range(random.randint(1, 4))]
        finally:
            bench.close()
        return any(took)

    return attempt


def _some(random: Random, bench: SetupBench) -> bytes:
    if random.random() < 0.2:
        return message("go", {"step": random.choice(STEPS)})
    verb, args = random.choice(verbs_in(bench.wizard.view().step))
    if args and random.random() < 0.3:
        return with_value(verb, args, random.choice(tuple(args)), random.choice(_VALUES))
    return message(verb, args)


def solved_strokes(place: Place) -> Attempt:
    """Strokes that nobody would draw, as the page sends them, and the light worked out from them."""

    def attempt(random: Random, number: int) -> bool:
        drawn = {}
        for name in ("cam0", "cam1")[: random.randint(1, 2)]:
            pixels, strokes = _drawing(random)
            size_px = pixels.shape[1], pixels.shape[0]
            text = base64.b64encode(png(strokes)).decode()
            shirt = (
                None if random.random() < 0.7 else (_scribbled(random, strokes) > 0) * np.uint8(1)
            )
            drawn[name] = StrokeDrawing(
                LabelledPicture(pixels, decode_strokes(text, size_px, name)), shirt
            )
        found = solve_colours(drawn, random.random() < 0.5, {})
        return any(one.W is not None for one in found.cameras.values())

    good = StrokeDrawing(LabelledPicture(sample((64, 48)), strokes_on((64, 48))))
    solve_colours({"cam0": good, "cam1": good}, True, {})
    for number in range(10):  # until all that is compiled for some of them is compiled
        attempt(Random(number), number)
    return attempt


def _drawing(random: Random) -> tuple[Bytes, Bytes]:
    """A picture (h,w,3) and strokes (h,w) on it."""
    size_px = random.choice(((64, 48), (16, 16), (3, 200), (1, 1), (160, 120)))
    width, height = size_px
    kind = random.randrange(5)
    pixels = sample(size_px, random.randrange(1 << 30))
    if kind == 0:
        pixels = np.full_like(pixels, random.choice((0, 1, 128, 254, 255)))
    elif kind == 1:
        pixels = np.frombuffer(random.randbytes(pixels.size), np.uint8).reshape(pixels.shape)
    strokes = np.zeros((height, width), np.uint8)
    if kind != 2 and width > 22:
        strokes = strokes_on(size_px)
    return pixels, _scribbled(random, strokes)


def _scribbled(random: Random, strokes: Bytes) -> Bytes:
    """With boxes of any colours drawn over it."""
    out = strokes.copy()
    height, width = out.shape
    for _ in range(random.randrange(12)):
        x, y = random.randrange(width), random.randrange(height)
        wide, high = random.choice((1, 2, 9, width)), random.choice((1, 2, 9, height))
        out[y : y + high, x : x + wide] = random.randrange(11)
    return out


def spoilt(random: Random) -> bytes:
    """A message of any step with damage anywhere, for whoever reads it first."""
    verb, args = random.choice([one for own in VERBS.values() for one in own])
    good = message(verb, args)
    return good if random.random() < 0.1 else mistyped(random, good, _VALUES)
