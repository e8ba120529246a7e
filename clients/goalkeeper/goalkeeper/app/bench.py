"""How fast the game draws beside a daemon: `python -m goalkeeper.app.bench`.

The demo as a player has it, daemon and simulated cameras included, drawn into a picture in memory by the software
renderer; after a few seconds every picture of a minute is timed.
"""

import os
import sys
import time
from argparse import ArgumentParser
from contextlib import closing
from pathlib import Path

import numpy as np
import platformdirs

from goalkeeper.app.end_signals import end_on_signals
from goalkeeper.app.game import Game, GameParts
from goalkeeper.app.window import SOFTWARE_HZ, WAITING_HZ, Pace, calm_collector
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.render.cameras import View
from goalkeeper.render.stage import Renderer, StageParams, open_stage
from goalkeeper.streams.demo_daemon import DemoStream
from goalkeeper.streams.scripted_shooter import ScriptedShooter
from mocapd.errors import MocapdError, UnavailableError
from mocapd.types import Floats

_SETTLE_S = 5.0  # after the first whistle
_MOST_START_S = 600.0  # the first start draws the cameras' film
_LATE_MS = 50.0


def main(arguments: list[str] | None = None) -> int:
    """The exit code."""
    parser = ArgumentParser(
        "bench", description="times the game's pictures beside the demo's daemon"
    )
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--view", choices=("behind", "first"), default="behind")
    parser.add_argument("--renderer", choices=("gl", "software"), default="software")
    parser.add_argument("--free", action="store_true", help="as fast as it goes")
    options = parser.parse_args(arguments)
    end_on_signals()
    try:
        stage = open_stage(
            StageParams((960, 540), Renderer(options.renderer), offscreen=True, sound=False)
        )
        with closing(DemoStream(platformdirs.user_cache_path("mocapd-goalkeeper"))) as stream:
            match = Match(MatchRules(round_s=3600.0), ScriptedShooter())
            game = Game(GameParts(stage, match, stream, None, Path(os.devnull)), View(options.view))
            _wait_for_play(game)
            calm_collector()
            _time(game, _SETTLE_S, None if options.free else Pace(SOFTWARE_HZ))
            used_s = time.process_time()
            apart_s, took_s = _time(
                game, options.seconds, None if options.free else Pace(SOFTWARE_HZ)
            )
            used_s = time.process_time() - used_s
    except MocapdError as error:
        print(f"bench: {error}", file=sys.stderr)
        return error.exit_code
    _report(game, apart_s, took_s, used_s)
    return 0


def _wait_for_play(game: Game) -> None:
    """Raises UnavailableError when the demo does not get there."""
    waiting, pace = Pace(WAITING_HZ), Pace(SOFTWARE_HZ)
    until_s = time.monotonic() + _MOST_START_S
    while game.match.phase is not Phase.PLAYING:
        game.frame()
        (waiting if game.waits else pace).wait()
        if time.monotonic() > until_s or game.stream_ended:
            raise UnavailableError("the demo did not begin", "bench", "see the lines above")


def _time(game: Game, seconds: float, pace: Pace | None) -> tuple[Floats, Floats]:
    """From each picture to the next, and what drawing each took [s]."""
    began_s = last_s = time.monotonic()
    apart, took = [], []
    while last_s - began_s < seconds:
        start_s = time.monotonic()
        game.frame()
        took.append(time.monotonic() - start_s)
        if pace is not None:
            pace.wait()
        now_s = time.monotonic()
        apart.append(now_s - last_s)
        last_s = now_s
    return np.array(apart), np.array(took)


def _report(game: Game, apart_s: Floats, took_s: Floats, used_s: float) -> None:
    apart_ms, took_ms = 1000 * apart_s, 1000 * took_s
    late = int((apart_ms > _LATE_MS).sum())
    print(
        f"960x540, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}; {len(apart_ms)} pictures"
    )
    print(f"rate            median {1000 / np.median(apart_ms):.1f} Hz")
    print(
        f"picture apart   median {np.median(apart_ms):.1f}  p99 {np.percentile(apart_ms, 99):.1f}"
        f"  longest {apart_ms.max():.1f} ms; over {_LATE_MS:.0f} ms: {late}"
    )
    print(
        f"picture took    median {np.median(took_ms):.1f}  p99 {np.percentile(took_ms, 99):.1f}"
        f"  longest {took_ms.max():.1f} ms; processor {1000 * used_s / len(took_ms):.1f} ms a picture"
    )
    score = game.match.score
    late_s = game.latency_s
    if late_s is not None:
        print(f"camera to screen, median {1000 * late_s:.0f} ms")
    print(f"{score.saves} saves, {score.goals} goals")


if __name__ == "__main__":
    sys.exit(main())
