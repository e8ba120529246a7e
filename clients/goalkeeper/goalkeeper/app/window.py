"""The program with a window: opens everything, minds the keys, ends in order."""

import gc
import time
from argparse import Namespace
from collections.abc import Callable
from contextlib import closing

import platformdirs
from panda3d.core import WindowProperties

from goalkeeper.app.end_signals import end_on_signals
from goalkeeper.app.game import Game, GameParts
from goalkeeper.app.high_scores import high_score_path
from goalkeeper.app.hud_text import PlayerSettings, level_of
from goalkeeper.core.match import Match, MatchRules
from goalkeeper.core.shots import RandomShooter, Shooter
from goalkeeper.render.cameras import View
from goalkeeper.render.stage import Renderer, Stage, StageParams, open_stage
from goalkeeper.sound.loudspeaker import Loudspeaker
from goalkeeper.streams.demo_daemon import DemoStream
from goalkeeper.streams.live_stream import LiveStream
from goalkeeper.streams.recorded_stream import RecordedStream
from goalkeeper.streams.scripted_shooter import ScriptedShooter
from goalkeeper.streams.shifted_stream import ShiftedStream
from goalkeeper.streams.sighting import PoseStream
from mocapd.client import Link

SOFTWARE_HZ = 75.0  # the processor's time belongs to the tracker too
WAITING_HZ = 15.0  # while there is nobody to be seen
_LOUDER = 0.1  # a press of + or -
_CALIBRATE_S = 8.0  # of a recording, in which nobody answers


def run_window(options: Namespace) -> int:
    """Until the player leaves; the exit code. Raises MocapdError; SystemExit after SIGTERM or SIGHUP."""
    end_on_signals()
    stage = open_stage(
        StageParams(
            options.size, Renderer(options.renderer), False, options.fullscreen, not options.mute
        )
    )
    with closing(open_stream(options)) as stream:
        match = Match(match_rules(options), open_shooter(options))
        sound = None if options.mute else Loudspeaker(stage.base)
        settings = PlayerSettings(options.difficulty, options.volume / 100.0, options.name)
        parts = GameParts(stage, match, stream, sound, high_score_path(), settings)
        game = Game(parts, View(options.view))
        play(game, stage)
    return 0


def play(game: Game, stage: Stage) -> None:
    """Picture after picture, until Esc or the window's end."""
    window = _Window(game, stage)
    calm_collector()
    waiting, pace = Pace(WAITING_HZ), Pace(SOFTWARE_HZ)
    while window.open:
        game.frame()
        if game.waits:
            waiting.wait()
        elif stage.software:
            pace.wait()


def open_stream(options: Namespace) -> PoseStream:
    """What the options name. Raises MocapdError."""
    if options.demo:
        return DemoStream(platformdirs.user_cache_path("mocapd-goalkeeper"))
    if options.recording is not None:
        return ShiftedStream(RecordedStream(options.recording, options.person))
    return LiveStream(Link(options.endpoint, options.instance, options.person, typed_options=True))


def open_shooter(options: Namespace) -> Shooter:
    """The demo's person cannot see; everybody else is shot at anywhere."""
    if options.demo and options.seed is None:
        return ScriptedShooter()
    return RandomShooter(time.time_ns() % 2**31 if options.seed is None else options.seed)


def match_rules(options: Namespace) -> MatchRules:
    """Of the options."""
    calibrate_s = _CALIBRATE_S if options.recording is not None else None
    level = level_of(options.difficulty)
    return MatchRules(
        round_s=options.round, calibrate_s=calibrate_s, shots=options.shots, level=level
    )


def calm_collector() -> None:
    """What is there stays: a full collection would cost a picture."""
    gc.collect()
    gc.freeze()


class Pace:
    """A constant rate, by sleeping."""

    def __init__(self, rate_hz: float) -> None:
        self._period_s = 1.0 / rate_hz
        self._due_s = time.monotonic()

    def wait(self) -> None:
        """Until the next picture is due; one that is late moves those after it."""
        self._due_s = max(self._due_s + self._period_s, time.monotonic())
        time.sleep(max(0.0, self._due_s - time.monotonic()))


class _Window:
    """Keys, and whether the window is still wanted."""

    def __init__(self, game: Game, stage: Stage) -> None:
        self.open = True
        self._stage = stage
        self._game, self._size_px = game, (1280, 720)
        base, match = stage.base, game.match
        for key, act in (
            ("v", game.switch_view),
            ("p", match.toggle_pause),
            ("c", match.recalibrate),
            ("d", game.harder),
            ("n", game.type_name),
            ("+", lambda: game.louder(_LOUDER)),
            ("=", lambda: game.louder(_LOUDER)),
            ("-", lambda: game.louder(-_LOUDER)),
            ("space", match.next_round),
            ("f", self._fill_screen),
        ):
            base.accept(key, self._unless_typed, [act])
        base.accept("escape", self._leave)
        for key in ("enter", "backspace"):
            base.accept(key, self._key, [key])
        base.buttonThrowers[0].node().setKeystrokeEvent("keystroke")
        base.accept("keystroke", self._key)
        base.win.setCloseRequestEvent("leave")
        base.accept("leave", self._leave)

    def _leave(self) -> None:
        self.open = False

    def _unless_typed(self, act: Callable[[], object]) -> None:
        """A name has these letters, too."""
        if not self._game.settings.types:
            act()

    def _key(self, key: str) -> None:
        if self._game.settings.types:
            self._game.typed(key)

    def _fill_screen(self) -> None:
        """The whole screen in its own size, and back to the window as it was."""
        window, pipe = self._stage.base.win, self._stage.base.pipe
        wanted = WindowProperties()
        if window.isFullscreen():
            wanted.setFullscreen(False)
            wanted.setSize(*self._size_px)
        else:
            self._size_px = window.getXSize(), window.getYSize()
            wanted.setFullscreen(True)
            if pipe.getDisplayWidth() > 0:
                wanted.setSize(pipe.getDisplayWidth(), pipe.getDisplayHeight())
        window.requestProperties(wanted)
