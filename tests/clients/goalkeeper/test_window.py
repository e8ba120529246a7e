"""Keys of the window, on a stand-in for Panda3D's window: none is opened."""

import importlib.util
import os
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("panda3d") is None and not os.environ.get("MOCAPD_REQUIRE_CLIENTS"),
    reason="Panda3D is not installed (pip install panda3d)",
)

SCREEN_PX, WINDOW_PX = (1920, 1080), (1000, 700)


class StandIn:
    """Panda3D's base and window: keeps what is accepted by key, and does what is asked of the window."""

    def __init__(self) -> None:
        self.keys: dict[str, Callable[[], object]] = {}
        self.size_px, self.full = WINDOW_PX, False
        self.win = SimpleNamespace(
            isFullscreen=lambda: self.full,
            getXSize=lambda: self.size_px[0],
            getYSize=lambda: self.size_px[1],
            requestProperties=self.request,
            setCloseRequestEvent=lambda name: None,
        )
        self.pipe = SimpleNamespace(
            getDisplayWidth=lambda: SCREEN_PX[0], getDisplayHeight=lambda: SCREEN_PX[1]
        )
        thrower = SimpleNamespace(setKeystrokeEvent=lambda name: None)
        self.buttonThrowers = [SimpleNamespace(node=lambda: thrower)]

    def accept(self, key: str, act: Callable[..., object], arguments: Any = ()) -> None:
        self.keys[key] = lambda: act(*arguments)

    def request(self, wanted: Any) -> None:
        self.full, self.size_px = wanted.getFullscreen(), (wanted.getXSize(), wanted.getYSize())


class Played:
    """A game of which the keys count what is pressed: frames go on until the window is left."""

    def __init__(self, keys: list[str], base: StandIn) -> None:
        self._pressed, self._base = iter(keys), base
        self.seen: list[tuple[bool, tuple[int, int]]] = []
        self.waits, self.volume = False, 1.0
        self.settings = SimpleNamespace(types=False)
        self.match = SimpleNamespace(toggle_pause=None, recalibrate=None, next_round=None)
        self.switch_view = self.harder = self.type_name = self.typed = None

    def louder(self, by: float) -> None:
        self.volume += by

    def frame(self) -> None:
        self._base.keys[next(self._pressed)]()
        self.seen.append((self._base.full, self._base.size_px))


def test_f_fills_the_screen_and_gives_the_window_back_and_plus_and_minus_are_the_volume() -> None:
    from goalkeeper.app.window import play

    base = StandIn()
    game = Played(["f", "f", "-", "-", "+", "escape"], base)
    play(game, SimpleNamespace(base=base, software=False))  # type: ignore[arg-type]
    assert game.seen[:2] == [(True, SCREEN_PX), (False, WINDOW_PX)]
    assert game.volume == pytest.approx(0.9)
    assert len(game.seen) == 6, "Esc ends it"
