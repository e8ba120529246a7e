"""`goalkeeper`: the program. An expected trouble is one line on stderr, its code the exit code."""

import sys
from argparse import Namespace

from goalkeeper.app.headless import Report, play_headless
from goalkeeper.app.hud_text import level_of
from goalkeeper.app.options import parse_options
from goalkeeper.core.shots import RandomShooter
from goalkeeper.streams.recorded_stream import RecordedStream
from mocapd.errors import MocapdError

_SIGINT_EXIT = 130
HEADLESS_SEED = 0


def main(arguments: list[str] | None = None) -> int:
    """The exit code."""
    options = parse_options(arguments)
    try:
        if options.headless:
            _print(_played(options))
            return 0
        # Panda3D is loaded for a window only
        from goalkeeper.app.window import run_window

        return run_window(options)
    except MocapdError as error:
        print(f"goalkeeper: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return _SIGINT_EXIT


def _played(options: Namespace) -> Report:
    stream = RecordedStream(options.recording, options.person)
    shooter = RandomShooter(HEADLESS_SEED if options.seed is None else options.seed)
    level = level_of(options.difficulty)
    return play_headless(stream, shooter, options.shots, options.round, level)


def _print(report: Report) -> None:
    for shot in report.shots:
        how = f"saved, {shot.limb}" if shot.limb else "goal"
        print(
            f"{shot.number + 1:4d}  {shot.kind:9s} {shot.speed_mps:5.1f} m/s  {how:22s} {shot.points:5d}"
        )
    score = report.score
    if report.pauses:
        print(f"the player was lost {report.pauses} times")
    print(
        f"score {score.points}: {score.saves} saves, {score.goals} goals, longest streak"
        f" {score.best_streak}, level {report.level:.2f} after {report.played_s:.1f} s"
    )
