"""The configuration: its file, flags and environment; scenarios; and the texts that name things in them."""

from collections.abc import Callable
from random import Random

from mocapd.assets import asset_path
from mocapd.calibration.board_spec import BoardKind, BoardSpec, aruco_board, board_size, corners_m
from mocapd.capture.kinds.source_kinds import (
    address_in_folder,
    cameras_of_origin,
    identity_of,
    is_simulated,
    open_source,
    origin_of,
)
from mocapd.capture.source_request import SourceRequest
from mocapd.config.config_keys import as_toml
from mocapd.config.effective import Effective, all_keys, load_config
from mocapd.config.sources import env_name
from mocapd.outputs.osc.osc_sink import parse_destination
from mocapd.outputs.zenoh.zenoh_config import Params, is_loopback, listen_endpoints, session_config
from mocapd.sim.film import first_frame
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import rig_of
from tests.capture.films import write_capture, write_film
from tests.fuzz.mutations import NUMBERS, TOML_LINES, TOML_VALUES, damaged, mistyped
from tests.fuzz.row import Attempt, Place, each_of, named, taken

CONFIG = """\
instance = "studio"
rig = "rig.json"
log_level = "debug"
cache_dir = "cache"
state_dir = "~/state"

[[camera]]
id = "left"
source = "usb:1-3.2:046d:0825:5F2A11B0"
fps_hz = 30.0
white_balance = "left.png"
controls = {auto_exposure = false, exposure = 150, gain = 20}

[[camera]]
id = "right"
source = "rtsp://admin:secret@192.168.1.20:554/stream?channel=1"

[tracker]
name = "shirt"
stature_m = 1.72
coast_s = 0.5

[bundler]
wait_s = 0.1

[prediction]
hz = 90
outputs = ["vmc"]

[shirt]
colour_model = "model"

[smoothing]
preset = "balanced"

[zenoh]
enabled = true
format = "json"
port = 7447
listen = ["tcp/127.0.0.1:7447"]
connect_timeout_s = 3.0

[osc]
destinations = ["127.0.0.1:39541", "[::1]:9000"]

[web]
enabled = true
port = 0
"""
_TEXTS = (
    *(value.strip('"') for value in TOML_VALUES), "", "\0", "\ud800", "x\0y", "~", "~nosuchuser/x", "[", '"', "'",
    '["tcp/127.0.0.1:7447"]', '["tls/0.0.0.0:7447#x"]', '[{id = "a", source = "0"}]',
    '[{id = "a", source = "~nosuchuser/x"}]', '[{id = "a", source = "rtsp://[bad"}]', "/" * 5000,
    "a/" * 3000, "full", "off", "2", "yes", "\n", "a = 1\nb = 2", "] = [", "é" * 300,
)  # fmt: skip
_CAMERAS = (
    "usb:1-3.2:046d:0825:5F2A11B0", "usb:1-3:046d:0825:", "/dev/video0", "0", "12", "rtsp://10.0.0.2/stream",
    "rtsp://admin:pass@10.0.0.2:554/stream?a=b#c", "http://[fe80::1%25eth0]:80/mjpg", "https://user@cam.lan/",
    "rtsps://u:p@[::1]:322/x", "rtsp://[bad", "http://a:b@c:d", "sim:living_room#left", "sim:./x.toml#a",
    "FOLDER#cam0", "FOLDER", "FILM", "~/film.mp4", "~nosuchuser/film.mp4", "film.mp4#cam0", "#", "usb:", "sim:",
    "zenoh://pi.lan/attic/left", "zenohs://pc:secret@[::1]:7447/attic/left?ca=/etc/ca.pem", "zenoh://a/b/c?ca=x&ca=/y",
    "zenohs://u@h/n/c", "zenoh://h:0/n/%2f", "zenoh:///n/c", "ZENOH://h/n/c?certificate=/a&private_key=/b", "zenoh://h/n/*",
)  # fmt: skip
_DESTINATIONS = (
    "127.0.0.1:39541", "[::1]:9000", "192.168.1.255:1", "localhost:9000", "::1:9000", "fe80::1%eth0:9000",
    "[fe80::1%lo]:9000", "127.0.0.1:", ":9000", "0.0.0.0:65535", "1:1", "::ffff:1.2.3.4:80",
)  # fmt: skip
_ENDPOINTS = (
    "tcp/127.0.0.1:7447", "tls/0.0.0.0:7447", "udp/[::1]:7447", "ws/localhost:7447", "quic/1.2.3.4:7447#iface=lo",
    "tcp/[::]:7447?prio=1", "unixsock-stream//tmp/x", "serial//dev/ttyACM0#baudrate=9600", "vsock/-1:7447",
    "tcp/127.0.0.1:99999", "tcp/[::ffff:127.0.0.1]:1", "TCP/127.1:7447", "tcp//127.0.0.1:7447",
)  # fmt: skip
_PIECES = (
    ":", "//", "/", "[", "]", "[::", "@", "#", "?", "%", "%00", "\0", "\n", " ", "~", "~nobody/", "..", "\ud800", "é",
    "٣", "²", "-1", "0x10", "1_0", "+1", "9" * 30, "9" * 5000, "x" * 300, "a" * 5000, "rtsp://", "sim:", "usb:", "#cam0",
    "\u2028", "127.0.0.1", "::1", "１２", "/dev/", "./", "*", "'", '"', "\\", "%25",
)  # fmt: skip
_SIZES = (
    *NUMBERS,
    "3x3",
    "4x5",
    "5X7",
    "20000x20000",
    " 4 x 5 ",
    "4x",
    "x5",
    "4x5x6",
    "٤x٥",
    "²x³",
    "-4x5",
    "4.0x5",
)


def files(place: Place) -> Attempt:
    """config.toml, with every value shown as `check-config` does."""
    path = place.folder / "config.toml"
    good = CONFIG.encode()

    def read() -> Effective:
        return load_config(file=path, env={})

    path.write_bytes(good)
    _show(read())

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(mistyped(random, good, TOML_VALUES, TOML_LINES))
        return taken(lambda: _show(read()))

    return attempt


def flags(place: Place) -> Attempt:
    """Every nasty text in every flag and variable."""
    keys = tuple(all_keys())
    cases = [(key, text, flag) for key in keys for text in _TEXTS for flag in (True, False)]

    def take(case: tuple[str, str, bool]) -> bool:
        key, text, flag = case
        given = {key: text} if flag else {}
        env = {} if flag else {env_name(key): text}
        return taken(lambda: _show(load_config(given, env=env, candidates=())))

    _show(load_config({"zenoh.port": "7448"}, env={"MOCAPD_OSC_ENABLED": "true"}, candidates=()))
    return each_of(cases, take)


def _show(effective: Effective) -> None:
    for setting in effective.settings:
        as_toml(setting.value)


def scenarios(place: Place) -> Attempt:
    """Scenario files, and the cameras and first frame of those that are taken."""
    folder = asset_path("scenarios")
    path = place.folder / "scenario.toml"
    goods = [one.read_bytes() for one in sorted(folder.glob("*.toml"))]

    def read() -> None:
        scenario = load_scenario(path)
        rig_of(scenario)
        first_frame(scenario)

    for good in goods:
        path.write_bytes(good)
        read()

    def attempt(random: Random, number: int) -> bool:
        path.write_bytes(mistyped(random, random.choice(goods), TOML_VALUES, TOML_LINES))
        return taken(read)

    return attempt


def cameras(place: Place) -> Attempt:
    """What a camera may be called in a configuration; nothing that is not a file is opened."""
    capture = write_capture(place.folder / "capture", frames=(1, 1))
    film = write_film(place.folder / "film.avi", 1)
    texts = [one.replace("FOLDER", str(capture)).replace("FILM", str(film)) for one in _CAMERAS]

    def name(text: str) -> None:
        identity_of(text)
        if is_simulated(text):
            cameras_of_origin(origin_of(text))
        address_in_folder(place.folder, text)
        open_source(text, SourceRequest(size_px=(64, 48)))

    for good in (str(film), f"{capture}#cam1", "rtsp://10.0.0.2/stream", "0", texts[0]):
        name(good)
    return _of_texts(texts, name)


def destinations(place: Place) -> Attempt:
    """Where OSC goes."""
    parse_destination("127.0.0.1:39541")
    return _of_texts(_DESTINATIONS, parse_destination)


def endpoints(place: Place) -> Attempt:
    """Where Zenoh listens, or which router it joins."""

    def use(text: str) -> None:
        is_loopback(text)
        for params in (Params(connect=(text,)), Params(listen=(text,), allow_unencrypted=True)):
            session_config(params)
            listen_endpoints(params)

    use("tcp/127.0.0.1:7447")
    return _of_texts(_ENDPOINTS, use)


def boards(place: Place) -> Attempt:
    """`--board-size`, and boards of all sizes."""

    def chessboard(size: tuple[int, int]) -> None:
        corners_m(BoardSpec(BoardKind.CHESSBOARD, *size, 0.03))

    def charuco(size: tuple[int, int]) -> None:
        spec = BoardSpec(BoardKind.CHARUCO, *size, 0.03, 0.02)
        aruco_board(spec, own_markers=True)
        corners_m(spec)

    def make(text: str) -> None:
        size = board_size(text)
        named(lambda: charuco(size))
        chessboard(size)

    make("5x7")
    return _of_texts(_SIZES, make)


def _of_texts(goods: tuple[str, ...] | list[str], use: Callable[[str], object]) -> Attempt:
    def attempt(random: Random, number: int) -> bool:
        text = _misspelt(random, random.choice(goods))
        return taken(lambda: use(text))

    return attempt


def _misspelt(random: Random, text: str) -> str:
    """Pieces put in, taken out, doubled; or bytes damaged."""
    if random.random() < 0.2:
        return damaged(random, text.encode("utf-8", "replace")).decode("utf-8", "surrogateescape")
    for _ in range(random.randint(1, 4)):
        begin = random.randint(0, len(text))
        end = begin + random.choice((0, 0, 1, 2, len(text)))
        piece = random.choice((*_PIECES, text, ""))
        text = text[:begin] + piece + text[end:]
    return text
