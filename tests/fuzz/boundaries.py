"""The functions through which everything from outside comes in, by themselves."""

import math
import os
from collections.abc import Callable
from pathlib import Path
from random import Random

import cv2

from mocapd.boundary.files import is_file, is_folder, read_file, read_text, user_path
from mocapd.boundary.image_decoding import (
    REDUCTIONS,
    decode_camera_picture,
    decode_picture,
    is_plain_jpeg,
    read_header,
)
from mocapd.boundary.numbers import brief, finite_number, whole_number, whole_number_of_text
from mocapd.boundary.parsing import convert, decode_json, decode_msgpack, parse_json, parse_toml
from mocapd.boundary.urls import split_url, without_password
from mocapd.capture.jpeg_picture import read_jpeg
from mocapd.errors import MalformedError, MocapdError
from mocapd.types import Frame
from mocapd.web.links.wizard_link import PageCommand
from tests.fuzz.damaged_pictures import damaged_jpeg, damaged_png, jpeg, png, sample
from tests.fuzz.large_pictures import large_picture
from tests.fuzz.mutations import JSON_VALUES, TOML_LINES, TOML_VALUES, damaged, mistyped
from tests.fuzz.row import Attempt, Place, WrongError, named, taken

_SIZE_PX = (40, 30)
_JSON = (
    b'{"verb": "board", "args": {"columns": 5, "names": ["a", "b"], "deep": {"x": [1.5, null]}}}'
)
_MSGPACK = b"\x82\xa4verb\xa5board\xa4args\x82\xa7columns\x05\xa5names\x92\xa1a\xa1b"
_TOML = (
    b'verb = "board"\n[args]\ncolumns = 5\nnames = ["a", "b"]\n[args.deep]\nx = [1.5, {y = 2}]\n'
)
_MOST_BYTES = 1000
_MOST_WORDS = 500  # that a library may write about one picture [bytes]
_NUMBERS: tuple[object, ...] = (
    0, -1, 1, 10**18, 10**19, -(10**400), 10**5000, 0.0, -0.0, 1e308, -1e308, 5e-324, math.nan, math.inf, -math.inf, 3.5,
    True, False, None, "", "3", "nan", [], {}, b"3", 1 + 2j, "x" * 10_000,
)  # fmt: skip
_DIGITS = (
    "5", " 5 ", "05", "+5", "-5", "5.0", "5e3", "0x5", "٥", "²", "５", "", "\0", "9" * 18, "9" * 19, "9" * 5000, "1_0",
    "\ud800",
)  # fmt: skip
_PATHS = (
    "", ".", "/", "/dev/zero", "/dev/null", "/dev/full", "/proc/self/mem", "fifo", "fifo/x", "gone", "x" * 300, "x/" * 3000,
    "\0", "a\0b", "\ud800", "~", "~nosuchuser", "~nosuchuser/x", "~\0", "~" + "x" * 5000, "../" * 50, "\n", "loop", "dir",
    "good", "good/", "dangling", "large", "latin", "é" * 300,
)  # fmt: skip
_SCHEMES = ("rtsp", "RTSP", "rtsps", "http", "https", "Http", " rtsp", "\trtsp", "\nhttp")
_USERS = ("admin", "", "a b", "us%40er", "é", "a/b", "a@b")
_ODD = (
    "",
    "@",
    "/",
    "#",
    "?",
    ":",
    "%",
    "[",
    "]",
    " ",
    "\n",
    "&",
    "=",
    ";",
    "\\",
    "é",
    "%40",
    "://",
    "*",
)
_HOSTS = ("10.0.0.2", "cam.lan:554", "[::1]:80", "[bad", "", "a b", "10.0.0.2:x", "[fe80::1%eth0]")
_KEYS = (
    "password",
    "PWD",
    "pass",
    "user_pass",
    "token",
    "access_token",
    "apikey",
    "key",
    "secret",
    "auth",
    "sig",
    "p",
    "pw",
)


def pictures(place: Place) -> Attempt:
    """PNG and JPEG: what is decoded has the size that was wanted."""
    pixels = sample(_SIZE_PX)
    goods = (png(pixels), png(pixels[..., 0]), jpeg(pixels), jpeg(pixels[..., 0]))
    for good in goods:
        decode_picture(good, cv2.IMREAD_COLOR, _SIZE_PX)

    def attempt(random: Random, number: int) -> bool:
        good = goods[number % len(goods)]
        is_png = number % len(goods) < 2
        data = (damaged_png if is_png else damaged_jpeg)(random, good)
        if not is_png and random.random() < 0.25:
            frame = Frame("", 0, 0, read_jpeg(data, _SIZE_PX, random.choice(list(REDUCTIONS))))
            try:
                return frame.pixels.shape[1::-1] == frame.size_px
            except MalformedError:
                raise WrongError("a picture that was taken small cannot be decoded whole") from None
        flags = random.choice((cv2.IMREAD_COLOR, cv2.IMREAD_GRAYSCALE, cv2.IMREAD_UNCHANGED))
        if random.random() < 0.5:
            read_header(data)
            is_plain_jpeg(data, _SIZE_PX)
            return taken(lambda: decode_picture(data, flags, most_pixels=1_000_000))
        picture = decode_picture(data, flags, _SIZE_PX)
        if picture.shape[:2] != _SIZE_PX[::-1] or picture.dtype != "uint8":
            raise WrongError(f"a picture of {picture.shape} {picture.dtype} is let in")
        return True

    return attempt


def large_pictures(place: Place) -> Attempt:
    """Pictures with more work in them than their size needs, as a camera's and as a file: the run's table says what they
    take, and no library fills the log."""
    size_px = (640, 480)
    decode_camera_picture(jpeg(sample(size_px)), size_px)

    def attempt(random: Random, number: int) -> bool:
        data = large_picture(random, size_px)
        before = os.fstat(2).st_size  # a file, while a row runs
        done = named(lambda: decode_camera_picture(data, size_px))
        done |= named(lambda: decode_picture(data, cv2.IMREAD_COLOR, most_bits=16))
        words = os.fstat(2).st_size - before
        if words > _MOST_WORDS:
            raise WrongError(f"{words} bytes are written to stderr")
        return done

    return attempt


def messages(place: Place) -> Attempt:
    """JSON, msgpack and TOML."""
    ways: tuple[Callable[[Random], object], ...] = (
        lambda random: decode_json(mistyped(random, _JSON, JSON_VALUES), PageCommand),
        lambda random: decode_json(mistyped(random, _JSON, JSON_VALUES), dict),
        lambda random: decode_msgpack(damaged(random, _MSGPACK), dict),
        lambda random: decode_msgpack(damaged(random, _MSGPACK), PageCommand),
        lambda random: parse_json(_text(mistyped(random, _JSON, JSON_VALUES))),
        lambda random: parse_toml(_text(mistyped(random, _TOML, TOML_VALUES, TOML_LINES))),
        lambda random: convert(
            parse_toml(_text(mistyped(random, _TOML, TOML_VALUES, TOML_LINES))), PageCommand
        ),
    )
    decode_json(_JSON, PageCommand)
    decode_msgpack(_MSGPACK, PageCommand)
    convert(parse_toml(_TOML.decode()), PageCommand)
    return lambda random, number: taken(lambda: ways[number % len(ways)](random))


def _text(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")


def numbers(place: Place) -> Attempt:
    """What comes out is in range, and finite."""

    def attempt(random: Random, number: int) -> bool:
        value = random.choice(_NUMBERS)
        brief(value)
        low = random.choice((-(10**6), 0, 3, 1e-3))
        high = low + random.choice((0, 1, 1e3, 1e9))
        text = random.choice(_DIGITS) + random.choice(("", "", "0", " ", "."))
        ways: tuple[Callable[[], float], ...] = (
            lambda: finite_number(value, low, high),
            lambda: whole_number(value, int(low), int(high)),
            lambda: whole_number_of_text(text, int(low), int(high)),
        )
        found = ways[number % len(ways)]()
        if not low - 1 <= found <= high:
            raise WrongError(f"{found} is not from {low} to {high}")
        return True

    return attempt


def files(place: Place) -> Attempt:
    """Paths of what is no file, or too much of one."""
    folder = place.folder
    (folder / "dir").mkdir()
    (folder / "good").write_text("good")
    (folder / "large").write_bytes(bytes(_MOST_BYTES + 1))
    (folder / "latin").write_bytes(b"\xe9")
    (folder / "dangling").symlink_to("nowhere")
    (folder / "loop").symlink_to("loop")
    os.mkfifo(folder / "fifo")
    assert read_text(folder / "good", _MOST_BYTES) == "good"

    def attempt(random: Random, number: int) -> bool:
        text = random.choice(_PATHS) + random.choice(("", "", "", "/", ".png", "\0"))
        path = folder / text if random.random() < 0.7 else Path(text)
        is_file(path)
        is_folder(path)
        named(lambda: user_path(text))
        return taken(lambda: (read_text if number % 2 else read_file)(path, _MOST_BYTES))

    return attempt


def urls(place: Place) -> Attempt:
    """However odd an address is, its password is not shown: as it is, nor in an error."""

    def attempt(random: Random, number: int) -> bool:
        password = f"hunter2{random.choice(_ODD)}{random.choice(_ODD)}SECRET"
        url = f"{random.choice(_SCHEMES)}://{random.choice(_USERS)}:{password}@{random.choice(_HOSTS)}/s"
        if random.random() < 0.3:
            password = f"hunter2{random.choice(('', '%', ':', '/', '+'))}SECRET"
            url = f"{random.choice(_SCHEMES[:6])}://{random.choice(_HOSTS)}/s?a=b&{random.choice(_KEYS)}={password}"
        shown, error = without_password(url), _refusal_of(url)
        for text in (shown, error):
            if "hunter2" in text or "SECRET" in text:
                raise WrongError(f"{url!r} is shown as {text!r}")
        return not error

    return attempt


def _refusal_of(url: str) -> str:
    try:
        split_url(url)
    except MocapdError as error:
        return str(error)
    return ""
