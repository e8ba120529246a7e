"""The command line: what is played, how it is seen."""

import argparse
from collections.abc import Callable
from pathlib import Path

from goalkeeper.app.high_scores import LONGEST_NAME
from mocapd.client import ENDPOINT

_ABOUT = "Keep the balls out with your own body, as mocapd sees it."
_SIZE = (1280, 720)


def parse_options(arguments: list[str] | None = None) -> argparse.Namespace:
    """Of these words, or of the program's own."""
    parser = argparse.ArgumentParser("goalkeeper", description=_ABOUT)
    of = parser.add_mutually_exclusive_group()
    of.add_argument("--demo", action="store_true", help="start a daemon on simulated cameras")
    of.add_argument("--recording", type=Path, metavar="FILE", help="play a file of `mocapd record`")
    of.add_argument("--endpoint", default=ENDPOINT, help="where the daemon is [%(default)s]")
    parser.add_argument("--instance", default="*", help="its name, where there are several")
    parser.add_argument("--person", type=_whole(0, 99), default=0, help="number of the person")
    parser.add_argument("--seed", type=_whole(0, 2**31 - 1), help="the same shots again")
    parser.add_argument(
        "--round", type=_whole(5, 3600), default=120, metavar="SECONDS", help="[%(default)s]"
    )
    parser.add_argument("--shots", type=_whole(1, 10000), help="end after so many instead")
    parser.add_argument(
        "--headless", action="store_true", help="play --recording without a window, print the score"
    )
    parser.add_argument(
        "--difficulty", choices=("easy", "normal", "hard"), default="normal", help="[%(default)s]"
    )
    parser.add_argument("--name", type=_name, default="", help="yours, for the high scores")
    seen = parser.add_argument_group("picture and sound")
    seen.add_argument("--view", choices=("behind", "first"), default="behind")
    seen.add_argument("--size", type=window_size, default=_SIZE, metavar="WxH", help="[1280x720]")
    seen.add_argument("--fullscreen", action="store_true")
    seen.add_argument(
        "--renderer", choices=("auto", "gl", "software"), default="auto",
        help="software: Panda3D's own, for machines without a graphics card",
    )  # fmt: skip
    seen.add_argument("--mute", action="store_true")
    seen.add_argument("--volume", type=_whole(0, 100), default=100, help="[%(default)s]")
    options = parser.parse_args(arguments)
    if options.headless and options.recording is None:
        parser.error("--headless needs --recording FILE")
    return options


def _whole(low: int, high: int) -> Callable[[str], int]:
    """A reader of whole numbers in a range."""

    def read(text: str) -> int:
        number = int(text)
        if not low <= number <= high:
            raise argparse.ArgumentTypeError(f"{text} is not from {low} to {high}")
        return number

    read.__name__ = "whole number"
    return read


def _name(text: str) -> str:
    """One that the table of high scores can hold."""
    if len(text) > LONGEST_NAME or not text.isprintable():
        raise argparse.ArgumentTypeError(
            f"it has more than {LONGEST_NAME} letters, or some that cannot be shown"
        )
    return text


def window_size(text: str) -> tuple[int, int]:
    """Of a text like 1280x720 [px]."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"{text!r} is not like 1280x720")
    size = int(width), int(height)
    if not (160 <= size[0] <= 7680 and 90 <= size[1] <= 4320):
        raise argparse.ArgumentTypeError(f"{text} is no size of a window")
    return size
