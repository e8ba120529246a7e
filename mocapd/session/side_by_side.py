"""Half of the cameras in a thread of its own, so that a frame set takes little longer than a frame."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import TypeVar

from mocapd.each import Each, in_turn

T = TypeVar("T")
R = TypeVar("R")


def each_camera() -> Each:
    """See Each; in turn where there is one processor."""
    return side_by_side if len(os.sched_getaffinity(0)) > 1 else in_turn


def side_by_side(work: Callable[[T], R], of: Iterable[T]) -> list[R]:
    """See Each. The caller does the first half."""
    things = list(of)
    if len(things) < 2:
        return in_turn(work, things)
    half = (len(things) + 1) // 2
    job = _other().submit(in_turn, work, things[half:])
    try:
        mine = in_turn(work, things[:half])
    finally:
        wait((job,))
    return mine + job.result()


@cache
def _other() -> ThreadPoolExecutor:
    """One thread for all trackers of the process: a pipeline steps one at a time."""
    return ThreadPoolExecutor(1, thread_name_prefix="cameras")
