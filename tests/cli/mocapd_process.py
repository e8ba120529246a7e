"""Runs the command line as a user does: in a process of its own, or its entry in this one.

Either way in the environment of the test, with all that is written to the streams, also by libraries.
"""

import contextlib
import logging
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import cv2
import pytest

from mocapd.cli.main import main

PATIENCE_S = 600.0  # after which a process is given up: a busy machine compiles for minutes
COMMAND = (sys.executable, "-m", "mocapd.cli.main")


@dataclass(frozen=True)
class Outcome:
    """How a command ended."""

    code: int
    out: str
    err: str


def mocapd(env: dict[str, str], *words: str | Path, cwd: Path | None = None) -> Outcome:
    """Run one command to its end."""
    done = subprocess.run(
        [*COMMAND, *map(str, words)],
        env=env,
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


def mocapd_here(env: dict[str, str], *words: str | Path, cwd: Path | None = None) -> Outcome:
    """Run one command to its end by its entry, in this process, whose libraries are imported already.

    For what is refused or told without threads or children. What a command sets of the process is set
    back: variables, working directory, streams, signals, logs, OpenCV's threads.
    """
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        with _as_a_process(env, ["mocapd", *map(str, words)], cwd), _streams(out, err):
            try:
                main()
                code = 0
            except SystemExit as end:
                code = end.code if isinstance(end.code, int) else int(end.code is not None)
        return Outcome(code, _read(out), _read(err))


@contextlib.contextmanager
def _as_a_process(env: dict[str, str], argv: list[str], cwd: Path | None) -> Iterator[None]:
    ours = os.environ.copy()
    handlers = {n: signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}
    root, threads = logging.getLogger(), cv2.getNumThreads()
    logs, level = root.handlers[:], root.level
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", argv)
        if cwd is not None:
            patch.chdir(cwd)
        # not closed by `force` of logging.basicConfig: they are pytest's
        root.handlers[:] = []
        try:
            _set_environment(env)
            yield
        finally:
            _set_environment(ours)
            root.handlers[:] = logs
            root.setLevel(level)
            cv2.setNumThreads(threads)
            for number, handler in handlers.items():
                signal.signal(number, handler)


def _set_environment(env: dict[str, str]) -> None:
    os.environ.clear()
    os.environ.update(env)


@contextlib.contextmanager
def _streams(out: IO[bytes], err: IO[bytes]) -> Iterator[None]:
    """stdout and stderr, and the descriptors 1 and 2 for libraries that are not Python."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [(number, os.dup(number)) for number in (1, 2)]
    try:
        for number, stream in ((1, out), (2, err)):
            os.dup2(stream.fileno(), number)
        with (
            os.fdopen(1, "w", closefd=False) as own_out,
            os.fdopen(2, "w", closefd=False) as own_err,
            contextlib.redirect_stdout(own_out),
            contextlib.redirect_stderr(own_err),
        ):
            yield
    finally:
        for number, copy in kept:
            os.dup2(copy, number)
            os.close(copy)


def _read(stream: IO[bytes]) -> str:
    stream.seek(0)
    return stream.read().decode()


def start(env: dict[str, str], *words: str | Path) -> subprocess.Popen[str]:
    """Start one command, without a terminal; whoever starts it ends it."""
    return subprocess.Popen(
        [*COMMAND, *map(str, words)],
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
