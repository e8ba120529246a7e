"""A simulated room with four webcams in USB sockets, and which of them a picture is of."""

import hashlib
from pathlib import Path

import platformdirs

from mocapd.sim.film import load_film
from mocapd.sim.scenario import load_scenario
from tests.capture.socket_control import SocketControl

# Two of one model with serials, and two of another without: told apart by their ports alone.
WEBCAMS = {
    "cam0": "usb:1-1:046d:0825:A0",
    "cam1": "usb:1-2:046d:0825:B1",
    "cam2": "usb:1-3:1bcf:28c4:",
    "cam3": "usb:1-4:1bcf:28c4:",
}
_PLACES = {"cam0": (-1.5, 2.4), "cam1": (1.6, 2.2), "cam2": (-2.4, -1.2), "cam3": (2.3, -1.4)}
_HEAD = """
name = "sockets"
fps_hz = {}
loop_s = 1.0
[[lights]]
name = "lamp"
position_m = [0.5, 2.2, 1.8]
colour = [1.0, 0.9, 0.8]
intensity = 5.0
[[motion.keyframes]]
t_s = 0.0
pose = "t_pose"
[[motion.keyframes]]
t_s = 0.5
pose = "relaxed"
at_m = [0.2, 0.1]
"""
_CAMERA = """
[[cameras]]
name = "{}"
position_m = [{}, 1.4, {}]
look_at_m = [0.0, 1.0, 0.0]
size_px = [320, 240]
"""
_THING = """
[[room.things]]
kind = "bookshelf"
base_m = [{}, 0.0, {}]
size_m = [0.8, 1.6, 0.4]
yaw_deg = {}
srgb = [{}, 120, 90]
"""


class SocketedRoom:
    """The scenario's file, the control of its sockets, and its pictures."""

    def __init__(self, folder: Path, rate_hz: float) -> None:
        path = folder / "sockets.toml"
        cameras = (_CAMERA.format(name, *place) for name, place in _PLACES.items())
        spots = ((-1.8, -2.2, 10), (1.2, -2.4, -20), (-1.4, 2.6, 160), (2.2, 1.9, 220))
        things = (_THING.format(*spot, 60 + 40 * i) for i, spot in enumerate(spots))
        path.write_text("".join((_HEAD.format(rate_hz), *cameras, *things)))
        self.control = SocketControl(folder / "sockets.json", WEBCAMS)
        self.words = ("--capture", f"sim:{path}@{self.control.path}", "--tracker", "canned")
        film = load_film(load_scenario(path), platformdirs.user_cache_path("mocapd"))
        self._of = {_mark(jpeg): name for name, jpegs in film.frames.items() for jpeg in jpegs}

    def shows(self, jpeg: bytes) -> str:
        """The webcam whose picture this is; empty for one of nobody's."""
        return self._of.get(_mark(jpeg), "")


def _mark(jpeg: bytes) -> bytes:
    return hashlib.blake2b(jpeg, digest_size=8).digest()
