"""Strokes: as the page sends them, and as files beside a picture."""

import base64
from pathlib import Path
from random import Random

import numpy as np

from mocapd.shirt.colour.model_pictures import read_model, stroked_folder
from mocapd.shirt.colour.strokes import read_labelled, stroke_means
from mocapd.wizard.colour.stroke_images import decode_strokes
from tests.fuzz.damaged_pictures import damaged_jpeg, damaged_png, jpeg, png, sample, strokes_on
from tests.fuzz.mutations import damaged
from tests.fuzz.row import Attempt, Place, named, taken

_SIZE_PX = (64, 48)
_NO_BASE64 = (
    "é",
    "\ud800",
    "====",
    "A",
    "",
    "AAAA\n",
    "\0",
    "data:image/png;base64,",
    "A" * 300_001,
    "-_-_",
)


def uploads(place: Place) -> Attempt:
    """Strokes in base64."""
    good = png(strokes_on(_SIZE_PX))
    others = (png(sample(_SIZE_PX)), jpeg(strokes_on(_SIZE_PX)), png(strokes_on((48, 64))))
    decode_strokes(base64.b64encode(good).decode(), _SIZE_PX, "cam0")

    def attempt(random: Random, number: int) -> bool:
        text = base64.b64encode(damaged_png(random, good)).decode()
        kind = random.random()
        if kind < 0.1:
            text = base64.b64encode(damaged(random, random.choice(others))).decode()
        elif kind < 0.2:
            at = random.randint(0, 80)
            text = f"{text[:at]}{random.choice(_NO_BASE64)}{text[at:]}"
        elif kind < 0.25:
            text = random.choice(_NO_BASE64)
        return taken(lambda: decode_strokes(text, _SIZE_PX, "cam0"))

    return attempt


def labelled_images(place: Place) -> Attempt:
    """A picture and its strokes in files, as a calibration, a capture and the configuration name them."""
    image, strokes = place.folder / "0.png", place.folder / "0_strokes.png"
    pixels = sample(_SIZE_PX)
    goods = {
        image: (png(pixels), jpeg(pixels)),
        strokes: (png(strokes_on(_SIZE_PX)), png(np.dstack([strokes_on(_SIZE_PX)] * 3))),
    }
    image.write_bytes(goods[image][0])
    strokes.write_bytes(goods[strokes][0])
    read_model(stroked_folder(place.folder))
    _means(image)

    def attempt(random: Random, number: int) -> bool:
        for path, ways in goods.items():
            path.write_bytes(ways[0])
        path = random.choice(tuple(goods))
        good = random.choice(goods[path])
        change = damaged_png if good.startswith(b"\x89PNG") else damaged_jpeg
        path.write_bytes(change(random, good))
        read = named(lambda: read_labelled(image))
        return named(lambda: _means(image)) or read

    return attempt


def _means(image: Path) -> None:
    one = read_labelled(image)
    stroke_means(one.pixels, one.labels)
